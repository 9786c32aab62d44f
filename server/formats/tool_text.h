// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kernel/tool/tool.h"

namespace kerf {

/// Describes a tool for the head of a program, e.g. "ball, diameter 10 mm, length 60 mm".
std::string tool_text(const ToolShape& shape);

}  // namespace kerf
