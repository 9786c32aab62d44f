// SPDX-License-Identifier: Apache-2.0
#include "server/session/made_tool.h"

#include <limits>
#include <utility>

namespace kerf {

ListRow to_row(const MadeTool& tool) {
  return {std::int64_t{tool.id}, static_cast<std::int64_t>(tool.record), tool.created_ms,
          tool_json(tool.id, tool.tool), tool.author};
}

std::optional<MadeTool> made_tool_of(const ListRow& row, double tolerance_mm) {
  const std::int64_t id = std::get<std::int64_t>(row.at(0));
  if (id < 1 || id > std::numeric_limits<ToolId>::max()) return std::nullopt;
  auto tool = parse_scene_tool(std::get<std::string>(row.at(3)), tolerance_mm);
  if (!tool) return std::nullopt;
  return MadeTool{.id = static_cast<ToolId>(id),
                  .record = static_cast<std::uint64_t>(std::get<std::int64_t>(row.at(1))),
                  .created_ms = std::get<std::int64_t>(row.at(2)),
                  .tool = *std::move(tool),
                  .author = std::get<std::string>(row.at(4))};
}

void add_made_tools(std::span<const ListRow> rows, Scene& scene) {
  for (const ListRow& row : rows) {
    if (auto made = made_tool_of(row, scene.settings.tolerance_mm))
      scene.tools.emplace(made->id, std::move(made->tool));
  }
}

}  // namespace kerf
