// SPDX-License-Identifier: Apache-2.0
#include "server/carve/tradeoff_run.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <utility>

#include "kernel/dexel/dexel_tile.h"
#include "kernel/dexel/stock_column.h"
#include "server/carve/cpu_budget.h"
#include "server/platform/clock.h"

namespace kerf {
namespace {

constexpr std::size_t kMotionsPerLook = 16;
// Allowed change of a pitch to fit the block in x and y.
constexpr double kFitShare = 0.12;

}  // namespace

std::expected<CarvedOnce, std::string> carve_once(const SculptureSettings& settings,
                                                  const Scene& scene, const Program& program,
                                                  const std::function<void(double)>& progress,
                                                  const std::stop_token& stop) {
  auto sculpture = Sculpture::create(settings);
  if (!sculpture) return std::unexpected(sculpture.error().reason);
  for (const auto& [id, tool] : scene.tools)
    if (auto defined = sculpture->apply(DefineTool{id, tool.tool}); !defined)
      return std::unexpected(defined.error().reason);
  std::vector<Vec3> forces;
  forces.reserve(program.motions.size());
  double cpu_s = 0, since = Clock::process_cpu_s();
  for (const ProgramMotion& motion : program.motions) {
    if (stop.stop_requested()) return std::unexpected(std::string());
    const auto result = sculpture->apply(
        MoveTool{motion.tool, motion.from, motion.to, motion.duration_s, !motion.rapid});
    if (!result)
      return std::unexpected("line " + std::to_string(motion.line) + ": " + result.error().reason);
    forces.push_back(result->wrench.force_n);
    if (forces.size() % kMotionsPerLook != 0 || !progress) continue;
    cpu_s += Clock::process_cpu_s() - since;
    progress(double(forces.size()) / double(program.motions.size()));
    since = Clock::process_cpu_s();
  }
  cpu_s += Clock::process_cpu_s() - since;
  const std::uint64_t bytes = sculpture->memory_bytes();
  return CarvedOnce{
      sculpture->solid(), cpu_s, sculpture->sub_motions(), bytes, sculpture->removed_volume_mm3(),
      std::move(forces)};
}

std::expected<Scene, std::string> with_tolerance(Scene scene, double tolerance_mm) {
  scene.settings.tolerance_mm = tolerance_mm;
  if (const auto resolved = resolve_chords(scene); !resolved)
    return std::unexpected("tool " + std::to_string(resolved.error().tool) + ": " +
                           resolved.error().error.field + " " + resolved.error().error.reason);
  return scene;
}

std::string machine_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "this machine";
}

double bytes_if_all_touched(const SculptureSettings& settings) {
  double bytes = 0;
  for (const RayAxis axis : {RayAxis::kX, RayAxis::kY, RayAxis::kZ}) {
    if (axis != RayAxis::kZ && settings.rays == Rays::kDexel) continue;
    const DexelGrid grid = make_grid(settings.stock, settings.pitch_mm, axis);
    bytes += double(grid.tiles_x()) * double(grid.tiles_y()) * double(sizeof(DexelTile));
  }
  return bytes;
}

double fitting_pitch(const StockShape& stock, double wanted_mm) {
  const DexelGrid grid = make_grid(stock, wanted_mm);
  const auto* box = std::get_if<BoxStock>(&stock);
  if (box == nullptr) return wanted_mm;
  const Vec3 size = box->max_mm - box->min_mm;
  double best_mm = wanted_mm, best_misfit = 1;
  for (double n = std::ceil(grid.columns_x * (1 - kFitShare));
       n <= grid.columns_x * (1 + kFitShare); ++n) {
    const double pitch = size.x / n;
    const double rows = size.y / pitch;
    const double misfit = std::abs(std::max(1.0, std::round(rows)) / rows - 1);
    const bool nearer = std::abs(pitch - wanted_mm) < std::abs(best_mm - wanted_mm);
    if (misfit < best_misfit - 1e-9 || (misfit < best_misfit + 1e-9 && nearer)) {
      best_misfit = misfit;
      best_mm = pitch;
    }
  }
  return best_mm;
}

double force_difference(const Program& program, const std::vector<Vec3>& forces_n,
                        const std::vector<Vec3>& reference_n) {
  double difference = 0, whole = 0;
  for (std::size_t n = 0; n < program.motions.size(); ++n) {
    const Vec3 d = forces_n[n] - reference_n[n];
    difference += dot(d, d) * program.motions[n].duration_s;
    whole += dot(reference_n[n], reference_n[n]) * program.motions[n].duration_s;
  }
  return whole > 0 ? std::sqrt(difference / whole) : 0;
}

}  // namespace kerf
