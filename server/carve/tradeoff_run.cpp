// SPDX-License-Identifier: Apache-2.0
#include "server/carve/tradeoff_run.h"

#include <cmath>
#include <ctime>
#include <utility>

#include "kernel/dexel/dexel_tile.h"
#include "kernel/dexel/stock_column.h"

namespace kerf {
namespace {

constexpr std::size_t kMotionsPerLook = 16;

}  // namespace

double cpu_seconds() {
  std::timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

std::expected<CarvedOnce, std::string> carve_once(const SculptureSettings& settings,
                                                  const Scene& scene, const Program& program,
                                                  const GoOn& go_on) {
  auto sculpture = Sculpture::create(settings);
  if (!sculpture) return std::unexpected(sculpture.error().reason);
  for (const auto& [id, tool] : scene.tools)
    if (auto defined = sculpture->apply(DefineTool{id, tool.tool}); !defined)
      return std::unexpected(defined.error().reason);
  std::vector<Vec3> forces;
  forces.reserve(program.motions.size());
  double cpu_s = 0, since = cpu_seconds();
  for (const ProgramMotion& motion : program.motions) {
    const auto result = sculpture->apply(
        MoveTool{motion.tool, motion.from, motion.to, motion.duration_s, !motion.rapid});
    if (!result)
      return std::unexpected("line " + std::to_string(motion.line) + ": " + result.error().reason);
    forces.push_back(result->wrench.force_n);
    if (forces.size() % kMotionsPerLook != 0) continue;
    cpu_s += cpu_seconds() - since;
    if (!go_on(double(forces.size()) / double(program.motions.size())))
      return std::unexpected(std::string());
    since = cpu_seconds();
  }
  cpu_s += cpu_seconds() - since;
  const std::uint64_t bytes = sculpture->memory_bytes();
  return CarvedOnce{
      sculpture->solid(), cpu_s, sculpture->sub_motions(), bytes, sculpture->removed_volume_mm3(),
      std::move(forces)};
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
