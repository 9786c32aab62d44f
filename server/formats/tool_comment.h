// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string_view>

#include "kernel/sculpture_command.h"

namespace kerf {

/// A comment about a tool, with the number of the tool.
struct NumberedComment {
  ToolId id = 0;
  std::string_view rest;  ///< the text after the number
};

/// Returns the number of the tool at the start of a comment: "T1", "TOOL 1", "TOOL NO. 1:", "TOOLS:
/// T9", "#3", "3 =". nullopt: it begins without one, or with a size ("TOOL 6MM", "#7 DRILL").
std::optional<NumberedComment> numbered_comment(std::string_view comment);

}  // namespace kerf
