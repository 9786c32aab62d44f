// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <stop_token>
#include <vector>

#include "kernel/dexel/dexel_snapshot.h"
#include "server/formats/model/mesh_distance.h"
#include "server/formats/program.h"
#include "server/formats/scene.h"

namespace kerf {

/// A region in which material of the reference was removed.
struct Gouge {
  double depth_mm = 0;  ///< greatest depth below the surface of the reference
  Vec3 deepest_mm;
  double area_mm2 = 0;                ///< projected along the rays
  double volume_mm3 = 0;              ///< below the surface of the reference
  std::optional<std::size_t> motion;  ///< index of the first motion that removed the deepest point
};

struct Gouges {
  double tolerance_mm = 0;
  std::size_t count = 0;     ///< of all gouges
  std::vector<Gouge> worst;  ///< deepest first, kGougesMax at most
};

/// Number of gouges that are listed individually.
inline constexpr std::size_t kGougesMax = 50;

/// Finds material of `before` that is missing in `after` deeper than `tolerance_mm` below the
/// surface of the reference. Every removed interval of every ray is searched, so that walls that
/// were removed entirely are found. Adjacent columns form one gouge. Ends early, with a part of the
/// gouges, if a stop is requested.
Gouges find_gouges(const DexelSnapshot& before, const DexelSnapshot& after,
                   const MeshDistance& reference, double tolerance_mm,
                   const std::function<void(double)>& progress = {},
                   const std::stop_token& stop = {});

/// Finds, for each of the worst gouges, the motion that first reached its deepest point; for those
/// that remain when a stop is requested, none.
void attribute_gouges(Gouges& gouges, const std::vector<ProgramMotion>& motions,
                      const std::map<ToolId, SceneTool>& tools, double tolerance_mm,
                      const std::stop_token& stop = {});

}  // namespace kerf
