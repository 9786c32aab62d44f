// SPDX-License-Identifier: Apache-2.0
#include "server/carve/carve_report.h"

#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "server/formats/derived_json.h"

namespace kerf {
namespace {

using Json = nlohmann::ordered_json;

std::uint64_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

// Bounds of the tip, which show why a program misses its block.
Json tip_extents(const Program& program) {
  if (program.motions.empty()) return nullptr;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3 low{kInfinity, kInfinity, kInfinity};
  Vec3 high{-kInfinity, -kInfinity, -kInfinity};
  for (const ProgramMotion& motion : program.motions) {
    for (const Vec3 p : {motion.from.tip_mm, motion.to.tip_mm}) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  }
  return {{"min_mm", {low.x, low.y, low.z}}, {"max_mm", {high.x, high.y, high.z}}};
}

Json simplified_json(const SurfaceReport& surface) {
  if (!surface.exact_triangles) return nullptr;
  return {{"exact_triangles", *surface.exact_triangles},
          {"error_mm", *surface.simplify_error_mm},
          {"crossing_triangles", surface.crossing_triangles}};
}

Json deviation_json(const SurfaceReport& surface) {
  if (!surface.deviation) return nullptr;
  const DistanceFigures& d = *surface.deviation;
  return {{"min_mm", d.min_mm}, {"max_mm", d.max_mm},   {"mean_mm", d.mean_mm},
          {"rms_mm", d.rms_mm}, {"p50_mm", d.p50_mm},   {"p90_mm", d.p90_mm},
          {"p99_mm", d.p99_mm}, {"samples", d.samples}, {"color_range_mm", surface.range_mm}};
}

}  // namespace

std::string hash_name(std::uint64_t hash) {
  std::array<char, 17> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(hash));
  return text.data();
}

std::string report_json(const CarveReport& report, const Scene& scene, const Program& program) {
  std::set<ToolId> tools;
  for (const ProgramMotion& motion : program.motions) tools.insert(motion.tool);
  const Json triangles = report.triangles ? Json(*report.triangles) : Json(nullptr);
  const Json json{{"scene", report.scene_file},
                  {"name", scene.name},
                  {"program", report.program_file},
                  {"program_lines", report.program_lines},
                  {"tools_used", tools},
                  {"tip_extents", tip_extents(program)},
                  {"accuracy", Json::parse(accuracy_json(scene))},
                  {"rays", to_string(scene.settings.rays)},
                  {"pitch_mm", scene.settings.pitch_mm},
                  {"tolerance_mm", scene.settings.tolerance_mm},
                  {"stock_volume_mm3", report.stock_volume_mm3},
                  {"removed_volume_mm3", report.removed_volume_mm3},
                  {"imprint_volume_mm3", report.imprint_volume_mm3},
                  {"motions", report.motions},
                  {"sub_motions", report.sub_motions},
                  {"machining_seconds", report.machining_s},
                  {"read_seconds", report.read_s},
                  {"cut_seconds", report.cut_s},
                  {"simulate_seconds", report.simulate_s},
                  {"wall_seconds", report.walls_s},
                  {"mesh_seconds", report.mesh_s},
                  {"write_seconds", report.write_s},
                  {"total_seconds", report.total_s},
                  {"threads", report.threads},
                  {"triangles", triangles},
                  {"simplified", simplified_json(report.surface)},
                  {"deviation", deviation_json(report.surface)},
                  {"peak_memory_bytes", peak_memory_bytes()},
                  {"stock_memory_bytes", report.stock_memory_bytes},
                  {"state_hash", hash_name(report.state_hash)},
                  {"verdict", Json::parse(report.verdict)},
                  {"simulation", Json::parse(report.simulation)},
                  {"thin_walls", Json::parse(report.walls)},
                  {"read_as", report.read_as},
                  {"provenance", Json::parse(provenance_json(report.origins))},
                  {"warnings", report.warnings}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void warn_of_idle_run(CarveReport& report) {
  if (report.removed_volume_mm3 > 0) return;
  report.warnings.push_back(
      report.program_file + ": NOTHING WAS CUT: " +
      (report.motions == 0 ? "the program has no motion of a tool"
                           : "no motion removes stock; compare tip_extents of --report with the "
                             "stock of the scene"));
}

}  // namespace kerf
