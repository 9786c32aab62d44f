// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "server/formats/scene.h"
#include "server/store/list_table.h"

namespace kerf {

/// A tool that was made in a session, after those of its first scene. A record of the journal
/// defines it for the kernel; a row of the table `tools` keeps its shape.
struct MadeTool {
  ToolId id = 0;                ///< unique in its session
  std::uint64_t record = 0;     ///< the record that defines it: no earlier motion uses it
  std::int64_t created_ms = 0;  ///< ms since 1970, UTC
  SceneTool tool;
  std::string author;  ///< name of the person who made it; empty if unknown
};

/// Converts a tool to its row in the journal, and back. Nullopt if the row has no valid tool.
ListRow to_row(const MadeTool& tool);
std::optional<MadeTool> made_tool_of(const ListRow& row, double tolerance_mm);

/// Adds the tools of a journal to its scene. Leaves out rows without a valid tool, and ids that the
/// scene has.
void add_made_tools(std::span<const ListRow> rows, Scene& scene);

inline constexpr const char* kMadeToolsTable = "tools";

}  // namespace kerf
