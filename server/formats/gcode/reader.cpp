#include "server/formats/gcode/reader.h"

#include <algorithm>

#include "server/formats/gcode/block.h"
#include "server/formats/gcode/fault.h"
#include "server/formats/gcode/machine.h"
#include "server/formats/motion_sink.h"
#include "server/formats/text_lines.h"

namespace kerf {
namespace {

bool is_percent(std::string_view line) {
  const auto first = line.find_first_not_of(" \t\r");
  if (first == std::string_view::npos || line[first] != '%') return false;
  return line.find_first_not_of(" \t\r", first + 1) == std::string_view::npos;
}

bool is_blank(std::string_view line) {
  return line.find_first_not_of(" \t\r") == std::string_view::npos;
}

class GcodeReader {
 public:
  GcodeReader(const std::string& name, const Scene& scene)
      : sink_(program_),
        machine_(scene, parameters_, sink_, [this](const std::string& text) { warn(text); }) {
    program_.name = name;
  }

  std::expected<Program, ProgramError> read(std::string_view text) {
    std::string_view word_line;
    try {
      TextLines lines(text);
      while (lines.next()) {
        line_ = lines.number();
        word_line = lines.line();
        if (!read_line(lines.line())) break;
      }
      if (!ended_) warn("the program ends without M2, M30 or %");
      while (lines.next()) {
        if (is_blank(lines.line()) || is_percent(lines.line())) continue;
        line_ = lines.number();
        warn("what follows the end of the program is not read");
        break;
      }
    } catch (const GcodeFault& fault) {
      return std::unexpected(ProgramError{program_.name, line_,
                                          fault.word.empty() ? trimmed(word_line) : fault.word,
                                          fault.reason});
    }
    program_.lines = line_;
    return std::move(program_);
  }

 private:
  // False at the end of the program.
  bool read_line(std::string_view line) {
    if (is_percent(line)) {
      if (started_) {
        ended_ = true;
        return false;
      }
      started_ = true;
      return true;
    }
    if (is_blank(line)) return true;
    started_ = true;
    GcodeBlock block = parse_gcode_block(line, parameters_);
    if (block.deleted) return true;
    ended_ = machine_.execute(block, line_);
    return !ended_;
  }

  static std::string trimmed(std::string_view line) {
    const auto first = line.find_first_not_of(" \t\r");
    const auto last = line.find_last_not_of(" \t\r");
    return first == std::string_view::npos ? std::string()
                                           : std::string(line.substr(first, last - first + 1));
  }

  void warn(const std::string& text) {
    // One that repeats on every line says no more than the first few.
    if (program_.warnings.size() < kProgramWarningsMax)
      program_.warnings.push_back(program_.name + ":" + std::to_string(line_) + ": " + text);
  }

  Program program_;
  GcodeParameters parameters_;
  MotionSink sink_;
  GcodeMachine machine_;
  std::size_t line_ = 0;
  bool started_ = false;
  bool ended_ = false;
};

}  // namespace

std::expected<Program, ProgramError> read_gcode(const std::string& name, std::string_view text,
                                                const Scene& scene) {
  return GcodeReader(name, scene).read(text);
}

}  // namespace kerf
