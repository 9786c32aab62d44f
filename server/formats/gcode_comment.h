// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/formats/post.h"

namespace kerf {

/// Returns "(text)", a comment that the control only displays, whatever the text: at most 200
/// bytes, brackets for parentheses, no control characters. Capital ASCII for Fanuc and Haas. For
/// grbl without the characters that it executes anywhere (grbl 1.1 wiki, "Real-time Commands": ? !
/// ~ and all bytes above 0x7f). For LinuxCNC with a dash before text that would open a file, run
/// Python or end the program (LinuxCNC 2.9, "G Code Overview", active comments). (MSG, …) is only
/// displayed.
std::string gcode_comment(Post post, std::string text);

}  // namespace kerf
