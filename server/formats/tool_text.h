// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kernel/tool/tool.h"

namespace kerf {

/// A tool in words for people, e.g. "ball, diameter 10 mm, length 60 mm".
std::string tool_text(const ToolShape& shape);

}  // namespace kerf
