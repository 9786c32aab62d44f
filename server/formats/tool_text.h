// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/sculpture_command.h"
#include "kernel/tool/tool_shape.h"

namespace kerf {

/// Returns a tool as text: "ball, diameter 8 mm, length 30 mm".
std::string tool_text(const ToolShape& shape);

/// Returns comments that describe a tool exactly, for the head of a program, each of at most 160
/// bytes of ASCII: "T2: ball, diameter 8 mm, length 30 mm". The points of an outline follow in
/// comments of their own: "T3 outline: 0 0, 3 9 about 0 5 out, 3 30", with "about" before a center
/// and "radius" before a radius.
std::vector<std::string> tool_comments(ToolId id, const ToolShape& shape);

/// Reads such comments again.
class ExportedTools {
 public:
  /// Adds the text of a comment after "T2", in any case. Returns whether it is one of
  /// tool_comments, and sets `shape` once the comments of this tool are complete.
  bool add(ToolId id, std::string_view text, std::optional<ToolShape>& shape);

 private:
  struct Texts {
    std::string tool, outline;
  };
  std::map<ToolId, Texts> texts_;
};

}  // namespace kerf
