// SPDX-License-Identifier: Apache-2.0
// What a page gets to know of a program and its block, as JSON.

#include <nlohmann/json.hpp>

#include "server/formats/program_path.h"
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

char letter_of(PathKind kind) {
  if (kind == PathKind::kStart) return 's';
  return kind == PathKind::kRapid ? 'r' : 'f';
}

}  // namespace

std::string ProgramBlock::about() const {
  const SculptureSettings& settings = scene_.settings;
  const DexelGrid& grid = sculpture_->grid();
  double machining_s = 0;
  for (const ProgramMotion& motion : program_.motions) machining_s += motion.duration_s;
  Json json{{"name", scene_.name},
            {"stock", Json::parse(stock_json(scene_))},
            {"tools", Json::parse(tools_json(scene_))},
            {"rays", to_string(settings.rays)},
            {"pitch_mm", settings.pitch_mm},
            {"tolerance_mm", settings.tolerance_mm},
            {"pivot_mm", settings.force.pivot_mm},
            {"motions", program_.motions.size()},
            {"lines", program_.lines},
            {"machining_s", machining_s},
            {"notes", notes_},
            {"warnings", program_.warnings}};
  json["grid"] = {{"origin_mm", json_of(grid.origin_mm)},
                  {"columns", {grid.columns_x, grid.columns_y}},
                  {"tile", kTileSide}};
  return text_of(json);
}

std::string ProgramBlock::progress() const {
  Json json{{"carved", carved_},
            {"machining_s", machining_s_},
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
