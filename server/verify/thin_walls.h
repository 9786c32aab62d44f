// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <vector>

#include "kernel/dexel/dexel_snapshot.h"
#include "server/verify/cut_surface.h"

namespace kerf {

/// A point where the true solid, or a groove in it, is too thin for the rays.
struct ThinWall {
  Vec3 mm;              ///< in the middle of the wall or groove
  double thickness_mm;  ///< along the normal
  /// The motion that cut one side; the number of motions if both are of the stock's mesh.
  std::uint32_t sweep;
  /// The same or a later motion, which cut the other side; the number of motions if that is the
  /// stock's own.
  std::uint32_t other_sweep;
  bool groove = false;   ///< void between two sides, not solid
  bool missing = false;  ///< mark_missing(): no column nearby is solid (or void)
};

/// Definition of a thin wall.
struct ThinWallLimits {
  double pitch_mm;      ///< distance of the rays
  double least_mm = 0;  ///< thinner films are ignored, because they are below the tolerance
};

/// Refinement of the pitch for a target.
struct WallTarget {
  double pitch_mm;      ///< coarsest pitch
  double target_mm;     ///< greatest distance of the true surface from the mesh, less the tolerance
  double least_mm = 0;  ///< thinner films are ignored
};

/// Finds, among points of the true surface, those of walls and grooves thinner than a pitch that
/// can fall between the rays, thinnest first. A point counts if no ball of a pitch's diameter fits
/// into the solid (the void) within a pitch of it (so the tip of a ridge of more than 39 degrees
/// does not count), and if the wall is also thin across the rays: a horizontal floor may have any
/// thickness. Ends early if a stop is requested or `effort` is spent.
std::vector<ThinWall> find_thin_walls(const TrueSolid& solid, const CutSurface& surface,
                                      const ThinWallLimits& limits,
                                      const std::stop_token& stop = {},
                                      QueryEffort* effort = nullptr);

inline constexpr double kFinestWallShare = 1.0 / 8;
/// Returns the coarsest pitch, at most target.pitch_mm and in steps of 10 %, at which thin walls,
/// grooves and the tips of sharp edges are expected to stay within the target: the distance from
/// every point of the surface to a ball of a pitch's diameter inside the solid, and to one outside
/// it, plus 0.65 pitches, is within the target. Empty if that needs less than kFinestWallShare of
/// target.pitch_mm.
std::optional<double> pitch_for_walls(const TrueSolid& solid, const CutSurface& surface,
                                      const WallTarget& target, const std::stop_token& stop = {},
                                      QueryEffort* effort = nullptr);

/// Joins points of the same wall or groove. Keeps the first of those with equal motions on both
/// sides, or within 16 pitches on the stock's mesh. Motions with equal values in `place_of_sweep`
/// count as one (a line of a program).
std::vector<ThinWall> distinct_walls(const std::vector<ThinWall>& walls,
                                     const std::vector<std::uint64_t>& place_of_sweep,
                                     double pitch_mm);

/// Marks the walls and grooves that a carved block lacks; `after`: a snapshot of its field along Z.
void mark_missing(std::vector<ThinWall>& walls, const DexelSnapshot& after);

}  // namespace kerf
