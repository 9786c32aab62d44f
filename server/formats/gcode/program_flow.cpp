// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/program_flow.h"

#include <string>

#include "server/formats/control/fault.h"

namespace kerf {

std::string_view ProgramFlow::line_text() const {
  const GcodeFile& file = source_.file(at_.file);
  return line_ == 0 || line_ > file.lines.size() ? std::string_view() : file.lines[line_ - 1];
}

std::optional<std::string_view> ProgramFlow::read_line() {
  const GcodeFile& file = source_.file(at_.file);
  if (at_.line >= file.lines.size()) return std::nullopt;
  const std::string_view text = file.lines[at_.line];
  line_ = ++at_.line;
  count_line();
  return text;
}

void ProgramFlow::count_line() {
  const bool idle = ++idle_ > kGcodeIdleLinesMax;
  if (++passed_ > lines_max_ || idle)
    throw ProgramFault{"", "the program does not end: it has executed " +
                               std::to_string(idle ? kGcodeIdleLinesMax : lines_max_) +
                               (idle ? " lines without a motion" : " lines")};
}

}  // namespace kerf
