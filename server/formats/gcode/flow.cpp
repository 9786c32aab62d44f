// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/flow.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/formats/control/fault.h"

namespace kerf {

using Keyword = OWord::Keyword;

GcodeFlow::GcodeFlow(GcodeSource& source, GcodeParameters& parameters, std::size_t lines_max,
                     Listener listener)
    : ProgramFlow(source, parameters, lines_max), listener_(std::move(listener)) {}

std::optional<GcodeLine> GcodeFlow::next() {
  for (std::size_t passed = 0; !ended_; ++passed) {
    if (passed == kGcodeLinesPerStep) return GcodeLine{};
    const auto text = read_line();
    if (!text) {
      if (frames_.size() == 1) return std::nullopt;
      throw ProgramFault{"", "the file ends within the subroutine O<" + frames_.back().subroutine +
                                 ">; endsub or return is missing"};
    }
    if (is_percent(*text)) {
      if (started_ && frames_.size() == 1) {
        ended_ = true;
        return std::nullopt;
      }
      started_ = true;
      continue;
    }
    GcodeLine line = split_gcode_line(*text);
    if (line.code.empty() && line.comment.empty()) continue;
    if (!line.code.empty()) started_ = true;
    if (line.code.starts_with('/')) continue;  // block delete is always on
    if (!is_o_word(line, frames_.size() > 1)) return line;
    execute(read(line, true));
  }
  return std::nullopt;
}

OWord GcodeFlow::read(const GcodeLine& line, bool with_values) const {
  return read_o_word(line, {parameters_, listener_.position_readable()}, with_values);
}

void GcodeFlow::execute(const OWord& word) {
  switch (word.keyword) {
    case Keyword::kSub:
      // Within a call the start of the subroutine; otherwise a definition, which is skipped.
      if (frames_.size() == 1) define(word);
      return;
    case Keyword::kProgram:
      return;
    case Keyword::kCall:
    case Keyword::kM98:
      return call(word);
    case Keyword::kEndsub:
    case Keyword::kReturn:
    case Keyword::kM99:
      return leave(word);
    case Keyword::kDo:
      new_label(word, LabelKind::kDo);
      return;
    case Keyword::kWhile:
      return execute_while(word);
    case Keyword::kRepeat:
      return begin_repeat(word);
    case Keyword::kEndwhile:
    case Keyword::kEndrepeat:
      return end_loop(word);
    case Keyword::kIf:
      return begin_if(word);
    case Keyword::kElseif:
    case Keyword::kElse:
      return end_branch(word);
    case Keyword::kEndif:
      if (label(word).kind != LabelKind::kIf) throw ProgramFault{word.text, "has no matching if"};
      return;
    case Keyword::kBreak:
      return break_loop(word, false);
    case Keyword::kContinue:
      return break_loop(word, true);
  }
}

void GcodeFlow::define(const OWord& word) {
  if (!subroutines_.emplace(word.name, Place{at_.file, at_.line - 1}).second)
    throw ProgramFault{word.text, "defines a subroutine that is already defined"};
  skip_to(word.name, {Keyword::kEndsub}, "is a subroutine without endsub");
}

// Finds "O<name> sub" (or a bare O number for M98): defined before, in its own file, or later in
// the current file.
std::optional<GcodeFlow::Place> GcodeFlow::find_subroutine(const std::string& name, bool fanuc) {
  if (const auto it = subroutines_.find(name); it != subroutines_.end()) return it->second;
  const std::size_t own = source_.find(name);
  const Place from = own != 0 ? Place{own, 0} : at_;
  const GcodeFile& file = source_.file(from.file);
  for (auto it = std::ranges::lower_bound(file.o_word_lines, from.line);
       it != file.o_word_lines.end(); ++it) {
    count_line();
    const GcodeLine line = split_gcode_line(file.lines[*it]);
    if (!is_o_word(line, true)) continue;
    const OWord word = read(line, false);
    const bool begins = word.keyword == (fanuc ? Keyword::kProgram : Keyword::kSub);
    if (begins && word.name == name) return subroutines_[name] = {from.file, *it};
  }
  return std::nullopt;
}

void GcodeFlow::call(const OWord& word) {
  const bool fanuc = word.keyword == Keyword::kM98;
  if (fanuc && word.repeats == 0) return;
  if (frames_.size() > kGcodeCallDepthMax)
    throw ProgramFault{word.text, "calls are nested deeper than " +
                                      std::to_string(kGcodeCallDepthMax) + " levels"};
  const auto place = find_subroutine(word.name, fanuc);
  if (!place)
    throw ProgramFault{
        word.text, "calls a subroutine that is neither in the program nor in a subroutine folder"};
  Frame frame{.subroutine = word.name, .back = at_, .shared = fanuc, .labels = {}};
  frame.repeats_left = word.repeats - 1;
  enter(*place, std::move(frame), word.values);
}

void GcodeFlow::enter(Place at, Frame frame, const std::vector<double>& arguments) {
  if (frame.shared) {
    parameters_.enter_sharing();
  } else {
    parameters_.enter(arguments);
  }
  frames_.push_back(std::move(frame));
  at_ = {at.file, at.line + 1};
  listener_.entered();
}

void GcodeFlow::leave(const OWord& word) {
  if (frames_.size() == 1) throw ProgramFault{word.text, "is allowed within a subroutine only"};
  Frame& frame = frames_.back();
  if (frame.shared != (word.keyword == Keyword::kM99))
    throw ProgramFault{word.text, frame.shared
                                      ? "must not end a program called by M98; use M99"
                                      : "must not end a subroutine called by call; use endsub"};
  listener_.returned(word.values.empty() ? std::nullopt : std::optional(word.values.front()));
  parameters_.leave();
  listener_.left();
  if (frame.repeats_left-- > 0) {
    const Place again = subroutines_.at(frame.subroutine);
    parameters_.enter_sharing();
    frame.labels.clear();
    at_ = {again.file, again.line + 1};
    listener_.entered();
    return;
  }
  at_ = frame.back;
  frames_.pop_back();
}

GcodeFlow::Label& GcodeFlow::new_label(const OWord& word, LabelKind kind) {
  const Place here{at_.file, at_.line - 1};
  const auto [it, added] = frames_.back().labels.emplace(word.name, Label{kind, here});
  if (!added && (it->second.kind != kind || it->second.place != here))
    throw ProgramFault{word.text, "uses a label that is already used in line " +
                                      std::to_string(it->second.place.line + 1)};
  return it->second;
}

GcodeFlow::Label& GcodeFlow::label(const OWord& word) {
  const auto it = frames_.back().labels.find(word.name);
  if (it == frames_.back().labels.end())
    throw ProgramFault{word.text, "has no matching start of a loop or branch"};
  return it->second;
}

OWord GcodeFlow::skip_to(const std::string& name, std::initializer_list<Keyword> keywords,
                         const std::string& reason) {
  const std::size_t from = line_;
  const GcodeFile& file = source_.file(at_.file);
  for (auto it = std::ranges::lower_bound(file.o_word_lines, at_.line);
       it != file.o_word_lines.end(); ++it) {
    line_ = *it + 1;
    count_line();
    const GcodeLine line = split_gcode_line(file.lines[*it]);
    if (!is_o_word(line, frames_.size() > 1)) continue;
    const OWord word = read(line, false);
    if (word.name != name || std::ranges::find(keywords, word.keyword) == keywords.end()) continue;
    at_.line = line_;
    return word.keyword == Keyword::kElseif ? read(line, true) : word;
  }
  line_ = from;
  throw ProgramFault{"O<" + name + ">", reason};
}

void GcodeFlow::execute_while(const OWord& word) {
  const auto known = frames_.back().labels.find(word.name);
  if (known != frames_.back().labels.end() && known->second.kind == LabelKind::kDo) {
    if (word.values.front() != 0) at_ = {known->second.place.file, known->second.place.line + 1};
    return;
  }
  new_label(word, LabelKind::kWhile);
  if (word.values.front() == 0)
    skip_to(word.name, {Keyword::kEndwhile}, "is a while without endwhile");
}

void GcodeFlow::begin_repeat(const OWord& word) {
  Label& loop = new_label(word, LabelKind::kRepeat);
  if (loop.repeats_left < 0)
    loop.repeats_left = static_cast<int>(std::clamp(std::round(word.values.front()), 0.0, 1e9));
  if (loop.repeats_left-- > 0) return;
  loop.repeats_left = -1;
  skip_to(word.name, {Keyword::kEndrepeat}, "is a repeat without endrepeat");
}

void GcodeFlow::end_loop(const OWord& word) {
  const Label& loop = label(word);
  if (loop.kind != (word.keyword == Keyword::kEndwhile ? LabelKind::kWhile : LabelKind::kRepeat))
    throw ProgramFault{word.text, "has no matching while or repeat"};
  at_ = loop.place;
}

void GcodeFlow::begin_if(const OWord& word) {
  new_label(word, LabelKind::kIf);
  OWord branch = word;
  while (branch.keyword != Keyword::kElse && branch.keyword != Keyword::kEndif &&
         branch.values.front() == 0)
    branch = skip_to(word.name, {Keyword::kElseif, Keyword::kElse, Keyword::kEndif},
                     "is an if without endif");
}

// Called at else and elseif after the preceding branch has been executed.
void GcodeFlow::end_branch(const OWord& word) {
  if (label(word).kind != LabelKind::kIf) throw ProgramFault{word.text, "has no matching if"};
  skip_to(word.name, {Keyword::kEndif}, "is an if without endif");
}

void GcodeFlow::break_loop(const OWord& word, bool again) {
  const Label loop = label(word);
  if (loop.kind != LabelKind::kWhile && loop.kind != LabelKind::kDo)
    throw ProgramFault{word.text, "has no matching while or do"};
  const bool is_do = loop.kind == LabelKind::kDo;
  if (again && !is_do) {
    at_ = loop.place;
    return;
  }
  skip_to(word.name, {is_do ? Keyword::kWhile : Keyword::kEndwhile}, "is a loop without an end");
  // continue: execute the while at the end of the do, which tests the condition.
  if (again) --at_.line;
}

}  // namespace kerf
