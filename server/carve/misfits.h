// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <stop_token>
#include <vector>

#include "kernel/dexel/dexel_snapshot.h"
#include "server/formats/program.h"
#include "server/formats/scene.h"
#include "server/verify/part_model.h"

namespace kerf {

/// A region in which a block differs from a part: a gouge, in which material of the part was
/// removed, or a rest, in which material was left outside the part.
struct Misfit {
  double depth_mm = 0;  ///< greatest distance from the surface of the part, > 0
  Vec3 deepest_mm;
  double area_mm2 = 0;    ///< projected along the rays
  double volume_mm3 = 0;  ///< between the block's surface and the part's
  /// Index of the motion that caused it.
  std::optional<std::size_t> motion;
};

struct Misfits {
  double tolerance_mm = 0;
  std::size_t count = 0;      ///< of all
  std::vector<Misfit> worst;  ///< deepest first, kMisfitsMax at most
};

/// Number of misfits listed individually.
inline constexpr std::size_t kMisfitsMax = 50;

/// Shows progress, 0 to 1, and ends a search early, with part of the result.
struct SearchControl {
  std::function<void(double)> progress = {};
  std::stop_token stop = {};
};

/// Finds material of `before` that is missing in `after` deeper than `tolerance_mm` below the
/// surface of the part. Every removed interval of every ray is searched, so walls that were removed
/// entirely are found. Adjacent columns form one gouge.
Misfits find_gouges(const DexelSnapshot& before, const DexelSnapshot& after, const PartModel& part,
                    double tolerance_mm, const SearchControl& control = {});

/// The reverse: finds material of `block` farther than `tolerance_mm` outside the part, whose
/// material() must not be null. Adjacent columns form one rest. Pieces that were cut loose do not
/// count (attached_material.h). Their volume is stored in `loose_mm3`.
Misfits find_rests(const DexelSnapshot& block, const PartModel& part, double tolerance_mm,
                   double& loose_mm3, const SearchControl& control = {});

/// Attributes each of the worst gouges to the motion that first reached its deepest point. Gouges
/// remaining when a stop is requested get no motion.
void attribute_gouges(Misfits& gouges, const std::vector<ProgramMotion>& motions,
                      const std::map<ToolId, SceneTool>& tools, double tolerance_mm,
                      const std::stop_token& stop = {});

/// Attributes each of the worst rests to the motion that comes nearest to its deepest point.
void attribute_rests(Misfits& rests, const Scene& scene, const std::vector<ProgramMotion>& motions,
                     const std::stop_token& stop = {});

}  // namespace kerf
