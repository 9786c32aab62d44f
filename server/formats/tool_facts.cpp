// SPDX-License-Identifier: Apache-2.0
#include "server/formats/tool_facts.h"

#include <algorithm>
#include <cmath>

#include "server/formats/gauge_sizes.h"
#include "server/formats/number_text.h"
#include "server/formats/tool_token_walk.h"

namespace kerf {
namespace {

using Word = ToolWord;

constexpr std::string_view kSeparators = ",-=:./|&*'\"[]{}+_#()";
/// The least number after POINT that is an angle without a unit.
constexpr double kPointMinDeg = 60;
/// The greatest number of a screw, and the fewest threads an inch of a numbered one.
constexpr double kScrewNumberMax = 12, kThreadsMin = 20;
/// Plausible angles of a V-bit, for a number without a unit after its name: "V60".
constexpr double kVeeMinDeg = 10, kVeeMaxDeg = 170;

class Grammar : public ToolTokenWalk {
 public:
  using ToolTokenWalk::ToolTokenWalk;

  ToolFacts read() {
    const auto each = [this](void (Grammar::*rule)(std::size_t)) {
      for (std::size_t i = 0; i < tokens_.size(); ++i)
        if (!claimed_[i]) (this->*rule)(i);
    };
    // Numbers with a name are claimed before those without one are read.
    each(&Grammar::phrase);
    each(&Grammar::name);
    each(&Grammar::number);
    each(&Grammar::rest);
    return std::move(facts_);
  }

 private:
  void add(Word word) { facts_.words.set(static_cast<std::size_t>(word)); }

  void number_is_ignored(std::size_t i, bool behind) {
    if (!number_of(i, behind)) claim(i);
  }

  // Pairs of words with a meaning of their own.
  void phrase(std::size_t i) {
    const Word here = meaning(i);
    if (is(i, "T") && (meaning(i + 1) == Word::kSlot || is(i + 2, "SLOT"))) {
      claim(i, is(i + 1, "-") ? 3 : 2);
      add(Word::kForm);
    } else if (here == Word::kGerund) {
      const Word next = meaning(i + 1);
      const bool noun = next == Word::kMill || next == Word::kTool || next == Word::kEnd ||
                        next == Word::kBit || next == Word::kDrill || next == Word::kBall;
      add(noun ? of_gerund(tokens_[i].word) : Word::kOperation);
      claim(i);
    } else if (here == Word::kCorner && is_rounding(i + 1)) {
      claim(i, 2);
      add(Word::kForm);
    } else if (here == Word::kDiameter && next_word(i) == Word::kRegister) {
      offset(i);
    } else if (here == Word::kTap && meaning(i + 1) == Word::kDrill) {
      claim(i);
    } else if (here == Word::kCount) {
      flute_count(i);
    } else if (is(i, "LETTER") || is_letter_drill(i)) {
      letter(is(i, "LETTER") ? i + 1 : i);
    } else if (is(i, "M") && is_free_number(i + 1) && tokens_[i + 1].glued) {
      thread(i);
    } else if (is(i, "A") && is_free_number(i + 1) && tokens_[i + 1].glued) {
      claim(i, 2);
      set_angle(tokens_[i + 1].value);
    } else if (is(i, "STOCK") && is(i + 1, "TO") && is(i + 2, "LEAVE")) {
      allowance(i);
    } else {
      pair(i);
    }
  }
  // "TWO FLUTES", "SINGLE-FLUTE". In front of another word the number is not understood.
  void flute_count(std::size_t i) {
    const std::size_t next = is(i + 1, "-") ? i + 2 : i + 1;
    if (meaning(next) == Word::kFlutes) claim(i, next - i + 1);
  }
  void pair(std::size_t i) {
    const std::size_t next = is(i + 1, "-") ? i + 2 : i + 1;
    const auto join = [&](std::string_view first, std::string_view second, Word word) {
      if (!is(i, first) || !is(next, second)) return;
      claim(i, next - i + 1);
      add(word);
    };
    join("COUNTER", "SINK", Word::kCountersink);
    join("COUNTER", "BORE", Word::kForm);
    join("DOVE", "TAIL", Word::kForm);
    join("V", "CARVE", Word::kVee);
    join("V", "GROOVE", Word::kVee);
  }
  // "XY STOCK TO LEAVE - .02" of Mastercam.
  void allowance(std::size_t i) {
    const bool axes = i > 0 && (is(i - 1, "XY") || is(i - 1, "Z"));
    std::size_t count = 0;
    const auto n = number_after(i + 2, count);
    claim(axes ? i - 1 : i, (n ? *n : i + 2) - (axes ? i - 1 : i) + 1);
  }
  Word next_word(std::size_t i) const {
    std::size_t next = i + 1;
    while (is_sign(next)) ++next;
    return meaning(next);
  }
  bool is_rounding(std::size_t i) const { return is(i, "ROUNDING") || is(i, "ROUND"); }
  static Word of_gerund(std::string_view word) {
    if (word == "DRILLING" || word == "BOHREN") return Word::kDrill;
    if (word.starts_with("ENGRAV") || word.starts_with("GRAV")) return Word::kVee;
    if (word == "CHAMFERING" || word == "DEBURRING" || word == "ENTGRATEN") return Word::kChamfer;
    if (word == "SPOTTING" || word == "CENTERING") return Word::kSpot;
    if (word == "TAPPING") return Word::kTap;
    if (word == "REAMING") return Word::kReamer;
    if (word == "THREADING") return Word::kThread;
    return Word::kNoise;
  }
  // "DIA. OFF. - 1": a register.
  void offset(std::size_t i) {
    std::size_t next = i + 1;
    while (is_sign(next)) ++next;
    claim(i, next - i);
    number_is_ignored(next, true);
  }
  bool is_letter_drill(std::size_t i) const {
    const bool drill = meaning(i + 1) == Word::kDrill;
    return drill && tokens_[i].word.size() == 1 && letter_drill_mm(tokens_[i].word).has_value();
  }
  void letter(std::size_t i) {
    const auto size = i < tokens_.size() ? letter_drill_mm(tokens_[i].word) : std::nullopt;
    if (!size) return;
    if (i > 0 && is(i - 1, "LETTER")) claim(i - 1);
    claim(i);
    facts_.sizes.push_back({.mm = *size, .named = true});
  }
  // M6 of a tap, and its pitch: M6x1, M6-1.0. For a thread mill it is not the diameter.
  void thread(std::size_t i) {
    bool taps = false;
    for (std::size_t n = 0; n < tokens_.size(); ++n)
      taps = taps || (meaning(n) == Word::kTap && meaning(n + 1) != Word::kDrill);
    if (!taps && !has_meaning(Word::kTap) && !has_meaning(Word::kThread)) return;
    claim(i, 2);
    pitch(i + 2);
    if (taps)
      facts_.sizes.push_back({.mm = tokens_[i + 1].value, .with_unit = true, .named = true});
  }
  void pitch(std::size_t i) {
    if ((is(i, "X") || is(i, "-") || is(i, "*")) && is_free_number(i + 1)) claim(i, 2);
  }

  // Words that name the number after or before them.
  void name(std::size_t i) {
    const Word here = meaning(i);
    switch (here) {
      case Word::kDiameter:
        return diameter(i);
      case Word::kCornerRadius:
        if (const auto n = number_of(i, true)) facts_.corner_mm = mm(*n);
        return;
      case Word::kCorner:
        return corner(i);
      case Word::kRadius:
        if (const auto n = number_of(i, true)) facts_.radius_mm = mm(*n);
        return;
      case Word::kAngle:
      case Word::kPoint:
      case Word::kHalf:
      case Word::kTaper:
        return angle(i, here);
      case Word::kLength:
        facts_.has_length = true;
        return number_is_ignored(i, !is(i, "LONG") && !is(i, "LANG"));
      case Word::kShank:
        return number_is_ignored(i, is(i, "SD"));
      case Word::kFlutes:
        return number_is_ignored(i, is(i, "Z"));
      case Word::kRate:
        return number_is_ignored(i, true);
      case Word::kRegister:
        return number_is_ignored(i, true);
      case Word::kNumber:
      case Word::kTool:
        return identity(i, here);
      case Word::kHelix:
        return number_is_ignored(i, false);
      case Word::kVee:
        return vee(i);
      default:
        return;
    }
  }
  // D of "| H1 | D1 |" is a register.
  void diameter(std::size_t i) {
    const bool letter = is(i, "D");
    const bool registers = std::ranges::any_of(
        tokens_, [](const ToolToken& t) { return t.word == "H" || t.word == "|"; });
    if (letter && registers && is_free_number(i + 1)) return claim(i, 2);
    if (const auto n = number_of(i, letter)) {
      if (negative(*n)) return facts_.unread.push_back("-" + decimal_text(tokens_[*n].value, 4));
      facts_.sizes.push_back({.mm = mm(*n), .with_unit = tokens_[*n].unit_mm > 0, .named = true});
    } else if (!letter) {
      claim(i);
    }
  }
  void corner(std::size_t i) {
    const bool radius = meaning(i + 1) == Word::kRadius;
    if (radius) claim(i);
    if (const auto n = number_of(radius ? i + 1 : i, true)) {
      facts_.corner_mm = mm(*n);
    } else if (radius && i > 0 && is_free_number(i - 1)) {
      facts_.corner_mm = mm(i - 1);
      claim(i - 1, 3);
    }
  }
  void angle(std::size_t i, Word here) {
    if (here == Word::kHalf || here == Word::kTaper) add(here);
    std::size_t name = i;
    // "TIP ANGLE 118", "HALF ANGLE 5".
    if (here != Word::kAngle && meaning(i + 1) == Word::kAngle) claim(name++);
    // "TIP RADIUS 1" is a corner radius, "TIP DIAMETER 1" a diameter that no shape has.
    if (here == Word::kPoint && meaning(i + 1) == Word::kRadius) {
      if (const auto n = number_of(i + 1, true)) facts_.corner_mm = mm(*n), claim(i);
      return;
    }
    if (here == Word::kPoint && meaning(i + 1) == Word::kDiameter) return;
    std::size_t count = 0;
    const auto after = number_after(name, count);
    const std::size_t dash = name > 0 && is(name - 1, "-") ? 1 : 0;
    const std::size_t before = name - 1 - dash;
    const bool is_before = name > dash && is_free_number(before) && tokens_[before].unit_mm == 0 &&
                           (tokens_[before].degrees || here == Word::kAngle);
    const bool is_after = after && tokens_[*after].unit_mm == 0 &&
                          (here == Word::kAngle || here == Word::kHalf || count > 1 ||
                           tokens_[*after].degrees || tokens_[*after].value >= kPointMinDeg);
    claim(i);
    if (!is_before && !is_after) return;
    const std::size_t n = is_before ? before : *after;
    claim(std::min(n, name), std::max(n, name) - std::min(n, name) + 1);
    set_angle(tokens_[n].value);
    facts_.angle_of_side = facts_.angle_of_side || here == Word::kHalf || here == Word::kTaper;
    facts_.angle_of_point = facts_.angle_of_point || here == Word::kPoint || is(i, "INCLUDED");
  }
  void set_angle(double deg) {
    if (facts_.angle_deg && *facts_.angle_deg != deg)
      facts_.unread.push_back(decimal_text(deg, 3) + " DEG");
    if (!facts_.angle_deg) facts_.angle_deg = deg;
  }
  // "TOOL 3", "NO. 7", "T5", "#7": the number of a tool or, for a drill, a gauge.
  void identity(std::size_t i, Word here) {
    if (here == Word::kTool) add(here);
    std::size_t count = 0;
    const auto n = number_after(i, count);
    const bool whole = n && tokens_[*n].unit_mm == 0 && !tokens_[*n].degrees &&
                       tokens_[*n].value == std::floor(tokens_[*n].value);
    if (!whole) {
      if (here != Word::kNumber || !is(i, "T")) claim(i);
      return;
    }
    if (here == Word::kTool && meaning(*n + 1) == Word::kDiameter) return claim(i);
    const bool gauge = here == Word::kNumber && !is(i, "T") && !is(i, "ID");
    const auto value = static_cast<int>(std::min(tokens_[*n].value, 1e6));
    if (gauge && next_noun(*n) == Word::kDrill) return gauge_size(i, count, number_drill_mm(value));
    if (gauge && is(*n + 1, "-") && is_free_number(*n + 2)) {
      gauge_size(i, count + 2, screw_mm(value));
      return;
    }
    claim(i, count + 1);
  }
  void gauge_size(std::size_t i, std::size_t count, std::optional<double> size) {
    claim(i, count + 1);
    if (!size) return facts_.unread.push_back(tokens_[i].word + " of no gauge");
    facts_.sizes.push_back({.mm = *size, .with_unit = true, .named = true});
  }
  // "V60", "60 V-BIT", "V-BIT 60": degrees, unless a unit is written.
  void vee(std::size_t i) {
    add(Word::kVee);
    claim(i);
    const auto is_angle = [&](std::size_t n) {
      return is_free_number(n) && tokens_[n].unit_mm == 0 && tokens_[n].value >= kVeeMinDeg &&
             tokens_[n].value <= kVeeMaxDeg && tokens_[n].value == std::floor(tokens_[n].value);
    };
    if (!is(i, "V")) return;
    const bool after = is_angle(i + 1) && (tokens_[i + 1].degrees || tokens_[i + 1].glued);
    if (!after && (i == 0 || !is_angle(i - 1))) return;
    claim(after ? i + 1 : i - 1);
    set_angle(tokens_[after ? i + 1 : i - 1].value);
  }

  void number(std::size_t i) {
    const ToolToken& number = tokens_[i];
    if (!number.is_number()) return;
    if (number.serial) return claim(i);
    if (number.degrees) {
      claim(i);
      return set_angle(number.value);
    }
    // The second number of "6x30" is a length, that of "12x2 bull nose" a corner; "3/8-16 TAP" has
    // 16 threads.
    const bool crossed = i > 0 && (is(i - 1, "X") || is(i - 1, "*"));
    const bool taps = facts_.has(Word::kTap) || next_kind(i) == Word::kTap;
    if (crossed && after_size_) {
      claim(i - 1, 2);
      const double value = mm(i);
      const bool is_corner = has_meaning(Word::kBull) && !facts_.corner_mm && !facts_.radius_mm;
      if (is_corner) {
        facts_.corner_mm = value;
      } else {
        facts_.has_length = true;
      }
      return;
    }
    if (taps && is_screw(i)) {
      claim(i, 3);
      return facts_.sizes.push_back(
          {.mm = *screw_mm(static_cast<int>(number.value)), .with_unit = true, .named = true});
    }
    if (taps && i > 0 && is(i - 1, "-") && after_size_ && number.unit_mm == 0) return claim(i);
    if (negative(i)) return;
    claim(i);
    after_size_ = true;
    std::size_t next = i + 1;
    if (is(next, "-")) ++next;
    facts_.sizes.push_back(
        {.mm = mm(i), .with_unit = number.unit_mm > 0, .before_kind = is_tool_kind(meaning(next))});
  }
  // "10-24" of a tap: a numbered screw and its threads per inch.
  bool is_screw(std::size_t i) const {
    const ToolToken& number = tokens_[i];
    return number.unit_mm == 0 && number.value == std::floor(number.value) &&
           number.value <= kScrewNumberMax && is(i + 1, "-") && is_free_number(i + 2) &&
           tokens_[i + 2].value >= kThreadsMin;
  }

  // Kinds, words without a number, and everything unexplained.
  void rest(std::size_t i) {
    const ToolToken& token = tokens_[i];
    if (token.is_number()) {
      facts_.unread.push_back(decimal_text(token.value, 4));
      return;
    }
    const Word here = meaning(i);
    const bool noted = is_tool_kind(here) || here == Word::kOperation || here == Word::kNegation;
    if (noted) add(here);
    const bool silent = here == Word::kNoise || here == Word::kFlutes || here == Word::kShank;
    const bool sign =
        token.word.size() == 1 && kSeparators.find(token.word[0]) != std::string_view::npos;
    const Word next = meaning(i + 1);
    // "6 X R1", "1/2 X .03R".
    const bool named = i + 1 < tokens_.size() && tokens_[i + 1].is_number() && claimed_[i + 1];
    const bool joins = is(i, "X") && (named || next == Word::kRadius ||
                                      next == Word::kCornerRadius || next == Word::kCorner);
    if (joins) return;
    const bool behind_equals = is(i, "=") && i + 1 == tokens_.size();
    if (!noted && !silent && (!sign || behind_equals)) facts_.unread.push_back(token.word);
  }

  bool after_size_ = false;
  ToolFacts facts_;
};

}  // namespace

ToolFacts read_tool_facts(std::string_view words, double unit_mm) {
  return Grammar(tool_tokens(words), unit_mm).read();
}

}  // namespace kerf
