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

/// CPU time of this process, s.
double cpu_seconds();

/// What came out of carving a program once.
struct CarvedOnce {
  SolidSnapshot snapshot;
  double cpu_s = 0;  ///< of the cuts, forces included
  std::uint64_t sub_motions = 0, bytes = 0;
  double removed_mm3 = 0;
  std::vector<Vec3> forces_n;  ///< one per motion
};

/// Asked now and then, with the share that is done: whether to go on.
using GoOn = std::function<bool(double share)>;

/// Carves every motion, forces included. The error says in a few words why it could not be done; it
/// is empty where `go_on` stopped it.
std::expected<CarvedOnce, std::string> carve_once(const SculptureSettings& settings,
                                                  const Scene& scene, const Program& program,
                                                  const GoOn& go_on);

/// Bytes of a stock at these settings if every tile of it is touched; what the budget is held
/// against.
double bytes_if_all_touched(const SculptureSettings& settings);

/// Root mean square of the difference of two forces, relative to that of the reference, over the
/// program's time.
double force_difference(const Program& program, const std::vector<Vec3>& forces_n,
                        const std::vector<Vec3>& reference_n);

}  // namespace kerf
