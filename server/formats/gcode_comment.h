// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/formats/post.h"

namespace kerf {

/// Returns "(text)", a comment that its control only shows, whatever the text: at most 200
/// bytes, brackets for parentheses, no control characters. Capital ASCII for Fanuc and Haas. For
/// grbl no character that it carries out wherever it stands (grbl 1.1 wiki, "Real-time Commands":
/// ? ! ~ and all bytes above 0x7f); for LinuxCNC a dash before what would open a file, run Python
/// or end the program (LinuxCNC 2.9, "G Code Overview", active comments). (MSG, …) is only shown.
std::string gcode_comment(Post post, std::string text);

}  // namespace kerf
