// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "kernel/sculpture.h"
#include "server/formats/program.h"
#include "server/formats/scene.h"

namespace kerf {

/// Result of carving a program once.
struct CarvedOnce {
  SolidSnapshot snapshot;
  double cpu_s = 0;  ///< of the cuts, forces included
  std::uint64_t sub_motions = 0, bytes = 0;
  double removed_mm3 = 0;
  std::vector<Vec3> forces_n;  ///< one per motion
};

/// Carves every motion, forces included. `progress` receives the fraction done at intervals. The
/// error states the reason in a few words. It is empty if a stop was requested, which takes effect
/// between motions.
std::expected<CarvedOnce, std::string> carve_once(const SculptureSettings& settings,
                                                  const Scene& scene, const Program& program,
                                                  const std::function<void(double)>& progress = {},
                                                  const std::stop_token& stop = {});

/// Returns a scene with another tolerance, and its fillets resolved for it. The error names the
/// tool whose fillets need too many pieces.
std::expected<Scene, std::string> with_tolerance(Scene scene, double tolerance_mm);

/// Returns the name of the processor.
std::string machine_name();

/// Returns the bytes of a stock with these settings if every tile is touched; compared with the
/// memory budget.
double bytes_if_all_touched(const SculptureSettings& settings);

/// Returns a pitch near the requested one that divides the block most nearly evenly in x and y,
/// because a remainder at the block's sides adds a volume error that is not due to cuts.
double fitting_pitch(const StockShape& stock, double wanted_mm);

/// Returns the rms difference of two force histories relative to the rms of the reference, over the
/// program's time.
double force_difference(const Program& program, const std::vector<Vec3>& forces_n,
                        const std::vector<Vec3>& reference_n);

}  // namespace kerf
