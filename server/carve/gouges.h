// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "kernel/dexel/dexel_snapshot.h"
#include "server/formats/model/mesh_distance.h"
#include "server/formats/program.h"
#include "server/formats/scene.h"

namespace kerf {

/// A region in which material was removed that the reference still has.
struct Gouge {
  double depth_mm = 0;  ///< how far below the reference's surface material is gone
  Vec3 deepest_mm;
  double area_mm2 = 0;                ///< seen along the rays
  double volume_mm3 = 0;              ///< below the reference's surface
  std::optional<std::size_t> motion;  ///< index of the first that took away the deepest place
};

struct Gouges {
  double tolerance_mm = 0;
  std::size_t count = 0;     ///< of all
  std::vector<Gouge> worst;  ///< deepest first, kGougesMax at most
};

/// So many gouges are told one by one.
inline constexpr std::size_t kGougesMax = 50;

/// What `after` lacks of `before` deeper than `tolerance_mm` below the reference's surface: every
/// removed part of every ray is searched, so that a wall that is gone altogether is found too.
/// Columns that touch are one gouge.
Gouges find_gouges(const DexelSnapshot& before, const DexelSnapshot& after,
                   const MeshDistance& reference, double tolerance_mm,
                   const std::function<void(double)>& progress = {});

/// Finds for each of the worst the motion that first reached its deepest place.
void attribute_gouges(Gouges& gouges, const std::vector<ProgramMotion>& motions,
                      const std::map<ToolId, SceneTool>& tools, double tolerance_mm);

}  // namespace kerf
