// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <string>
#include <vector>

#include "kernel/sculpture.h"
#include "server/formats/program.h"
#include "server/formats/scene.h"

namespace kerf {

/// Returns the CPU time of this process, s.
double cpu_seconds();

/// Result of carving a program once.
struct CarvedOnce {
  SolidSnapshot snapshot;
  double cpu_s = 0;  ///< of the cuts, forces included
  std::uint64_t sub_motions = 0, bytes = 0;
  double removed_mm3 = 0;
  std::vector<Vec3> forces_n;  ///< one per motion
};

/// Receives the fraction done from time to time; returns false to stop.
using GoOn = std::function<bool(double share)>;

/// Carves every motion, forces included. The error states the reason in a few words; it is empty if
/// `go_on` stopped it.
std::expected<CarvedOnce, std::string> carve_once(const SculptureSettings& settings,
                                                  const Scene& scene, const Program& program,
                                                  const GoOn& go_on);

/// Returns the bytes of a stock with these settings if every tile is touched; compared with the
/// memory budget.
double bytes_if_all_touched(const SculptureSettings& settings);

/// Returns the rms difference of two force histories relative to the rms of the reference, over the
/// program's time.
double force_difference(const Program& program, const std::vector<Vec3>& forces_n,
                        const std::vector<Vec3>& reference_n);

}  // namespace kerf
