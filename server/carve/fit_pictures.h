// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "kernel/cut/workers.h"
#include "kernel/dexel/dexel_snapshot.h"
#include "server/formats/model/mesh_distance.h"

namespace kerf {

/// A picture of a block.
struct FitPicture {
  const char* caption;  ///< side of the view
  std::string png;      ///< bytes
};

/// The distance from the part at which colors are full, in tolerances.
inline constexpr double kFullColorTolerances = 4;

/// Pictures of a block from several sides: wood within the tolerance of the part, blue where it is
/// cut too deep, red where material was left. Fewer pictures if a stop is requested.
std::vector<FitPicture> fit_pictures(const DexelSnapshot& block, const MeshDistance& part,
                                     double tolerance_mm, Workers& workers,
                                     const std::stop_token& stop);

}  // namespace kerf
