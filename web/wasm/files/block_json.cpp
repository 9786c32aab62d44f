// SPDX-License-Identifier: Apache-2.0
// What a page gets to know of a program and its block, as JSON.

#include <nlohmann/json.hpp>

#include "kernel/kernel_version.h"
#include "server/formats/program_path.h"
#include "web/wasm/files/journal_block.h"
#include "web/wasm/files/program_block.h"

namespace kerf::page {
namespace {

using Json = nlohmann::json;

/// As many as the server gives to a page.
constexpr std::size_t kPathPointsMax = 20'000;

/// Comments and names of a program may be in any encoding.
std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json json_of(const Vec3& v) { return {v.x, v.y, v.z}; }
Json json_of(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

/// What a page shows of every block.
Json about_block(const Scene& scene, const DexelGrid& grid) {
  const SculptureSettings& settings = scene.settings;
  Json json{{"name", scene.name},
            {"stock", Json::parse(stock_json(scene))},
            {"tools", Json::parse(tools_json(scene))},
            {"rays", to_string(settings.rays)},
            {"pitch_mm", settings.pitch_mm},
            {"tolerance_mm", settings.tolerance_mm},
            {"pivot_mm", settings.force.pivot_mm}};
  json["grid"] = {{"origin_mm", json_of(grid.origin_mm)},
                  {"columns", {grid.columns_x, grid.columns_y}},
                  {"tile", kTileSide}};
  return json;
}

/// Fields and values as in the frame of tools (server/wire/README.md, "Tool state").
Json tool_json(const wire::ToolState& tool) {
  return {{"participant", tool.participant},
          {"tool_id", tool.tool_id},
          {"tip_mm", json_of(tool.tip_mm)},
          {"axis", json_of(Vec3(tool.axis))},
          {"status", tool.status},
          {"force_n", json_of(Vec3(tool.force_n))},
          {"torque_nmm", json_of(Vec3(tool.torque_nmm))},
          {"removed_rate_mm3_per_s", tool.removed_rate_mm3_per_s}};
}

char letter_of(PathKind kind) {
  if (kind == PathKind::kStart) return 's';
  return kind == PathKind::kRapid ? 'r' : 'f';
}

}  // namespace

std::string ProgramBlock::about() const {
  double machining_s = 0;
  for (const ProgramMotion& motion : program_.motions) machining_s += motion.duration_s;
  Json json = about_block(scene_, sculpture_->grid());
  json["motions"] = program_.motions.size();
  json["lines"] = program_.lines;
  json["machining_s"] = machining_s;
  json["notes"] = notes_;
  json["derived"] = Json::parse(derived_);
  json["warnings"] = program_.warnings;
  return text_of(json);
}

std::string ProgramBlock::progress() const {
  Json json{{"carved", carved_},
            {"machining_s", machining_s_},
            {"time_s", machining_s_},
            {"next_s", json_of(next_s())},
            {"removed_mm3", sculpture_->removed_volume_mm3()},
            {"line", 0}};
  if (carved_ > 0) {
    const ProgramMotion& motion = program_.motions[carved_ - 1];
    if (motion.file == 0) json["line"] = motion.line;
    json["tool"] = motion.tool;
    json["tip_mm"] = json_of(motion.to.tip_mm);
    json["axis"] = json_of(motion.to.axis);
  }
  return text_of(json);
}

std::string JournalBlock::about() const {
  Json json = about_block(*scene_, *grid_);
  json["motions"] = log_->last();
  json["lines"] = 0;
  json["machining_s"] = 0;
  json["notes"] = json["warnings"] = Json::array();
  json["kernel_version"] = kKernelVersion;
  json["made"] = Json::array();
  for (const MadeHere& made : made_)
    json["made"].push_back(
        {{"tool", made.id}, {"record", made.record}, {"created_ms", made.wall_ms}});
  return text_of(json);
}

std::string JournalBlock::progress() const {
  Json tools = Json::array();
  for (const wire::ToolState& tool : block_->tools().tools) tools.push_back(tool_json(tool));
  return text_of({{"carved", block_->record()},
                  {"time_ms", block_->time_ms()},
                  {"machining_s", 0},
                  {"time_s", time_s(block_->record())},
                  {"next_s", json_of(next_s())},
                  {"removed_mm3", block_->removed_mm3()},
                  {"line", 0},
                  {"tools", std::move(tools)}});
}

std::string ProgramBlock::path() const {
  const ProgramPath path = drawn_path(program_, kPathPointsMax);
  std::string kinds;
  Json x = Json::array(), y = x, z = x, times = x, lines = x;
  for (const PathPoint& point : path.points) {
    kinds += letter_of(point.kind);
    x.push_back(point.tip_mm.x);
    y.push_back(point.tip_mm.y);
    z.push_back(point.tip_mm.z);
    times.push_back(point.time_s);
    lines.push_back(point.line);
  }
  return text_of({{"error_mm", path.error_mm},
                  {"kind", kinds},
                  {"x_mm", x},
                  {"y_mm", y},
                  {"z_mm", z},
                  {"time_s", times},
                  {"line", lines}});
}

}  // namespace kerf::page
