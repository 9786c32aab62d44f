// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/replica/block_source.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "kernel/dexel/stock_column.h"
#include "server/formats/scene.h"
#include "server/wire/limits.h"

namespace kerf::agent {
namespace {

using nlohmann::json;

/// Returns the scene fields of the welcome; throws json::exception if one is missing.
std::string scene_text(const json& welcome) {
  json accuracy;
  for (const char* field : {"rays", "pitch_mm", "tolerance_mm", "motion"}) {
    accuracy[field] = welcome.at("accuracy").at(field);
  }
  const json scene = {{"name", "copy"},
                      {"stock", welcome.at("stock")},
                      {"accuracy", accuracy},
                      {"tools", welcome.at("tools")},
                      {"force", welcome.at("force")}};
  return scene.dump();
}

}  // namespace

std::expected<BlockSource, std::string> BlockSource::read(std::string_view welcome) {
  BlockSource source;
  try {
    const json message = json::parse(welcome);
    const auto scene = parse_scene(scene_text(message), {.name = "welcome", .base_folder = {}});
    if (!scene) return std::unexpected(to_string(scene.error()));
    source.settings_ = scene->settings;
    source.settings_.keep_normals = false;
    for (const auto& [id, tool] : scene->tools) source.tools_.emplace(id, tool.tool);
    source.speed_max_mm_per_s_ =
        message.value("limits", json::object()).value("speed_mm_per_s", wire::kMaxSpeedMmPerS);
  } catch (const json::exception& error) {
    return std::unexpected(error.what());
  }
  if (const auto block = Sculpture::create(source.settings_); !block) {
    return std::unexpected(block.error().reason);
  }
  return source;
}

std::expected<std::map<ToolId, Tool>, std::string> BlockSource::add_tools(
    std::string_view message) {
  std::map<ToolId, Tool> added;
  try {
    const json parsed = json::parse(message);
    for (const json& item : parsed.at("tools")) {
      const ToolId id = item.at("id");
      if (tools_.contains(id)) continue;
      const auto tool = parse_scene_tool(item.dump(), settings_.tolerance_mm);
      if (!tool) return std::unexpected(to_string(tool.error()));
      added.emplace(id, tool->tool);
    }
  } catch (const json::exception& error) {
    return std::unexpected(error.what());
  }
  tools_.insert(added.begin(), added.end());
  return added;
}

double BlockSource::full_cut_mm2(ToolId tool) const {
  const auto found = tools_.find(tool);
  if (found == tools_.end()) return 0;
  const BoxStock box = stock_bounds(settings_.stock);
  const double height_mm = std::min(found->second.length_mm, length(box.max_mm - box.min_mm));
  return 2 * found->second.radius_mm * height_mm;
}

Sculpture BlockSource::make() const {
  Sculpture block = *Sculpture::create(settings_);
  for (const auto& [id, tool] : tools_) block.apply(DefineTool{id, tool}).value();
  return block;
}

}  // namespace kerf::agent
