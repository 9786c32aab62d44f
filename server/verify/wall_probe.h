// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/verify/cut_surface.h"
#include "server/verify/thin_walls.h"

namespace kerf {

/// The two sides of a surface: a wall is thin solid, a groove is thin void.
enum class SurfaceSide { kSolid, kVoid };

/// Tests at points of a solid's surface whether a wall or a groove there is too thin for the rays.
class WallProbe {
 public:
  /// `reach_mm`: distance from a point within which a ball of a pitch's diameter must fit. `solid`
  /// and `effort`, which may be null, must outlive this object.
  WallProbe(const TrueSolid& solid, const ThinWallLimits& limits, double reach_mm,
            QueryEffort* effort);

  /// Thickness at a point, measured along the normal.
  struct Thinness {
    double thickness_mm;  ///< more than a pitch without another side within that
    Vec3 middle;
  };
  /// Returns the thickness if the material on that side of the point may fall between the rays.
  std::optional<Thinness> thin_at(const CutPoint& point, SurfaceSide side) const;
  /// Returns the wall or groove at a point if it is thin and its sides face each other.
  std::optional<ThinWall> wall_at(const CutPoint& point, SurfaceSide side) const;

 private:
  /// A signed distance inside one side, and the direction in which it grows.
  struct Space {
    double mm;
    Vec3 deeper;
  };
  bool is_thick(const CutPoint& point, SurfaceSide side) const;
  template <class SpaceAt>
  bool fits_after_moves(const CutPoint& point, Vec3 into, SpaceAt&& space_at) const;
  bool fits_in_solid(const CutPoint& point) const;
  bool fits_in_tool(const CutPoint& point) const;
  bool fits_nearby(const CutPoint& point, SurfaceSide side) const;
  bool ball_fits(Vec3 center, SurfaceSide side) const;
  Space from_sides(Vec3 point) const;
  bool is_on(Vec3 point, SurfaceSide side) const;
  double thickness_at(Vec3 point, Vec3 into, SurfaceSide side) const;
  bool is_seen_along_z(Vec3 point, SurfaceSide side) const;

  const TrueSolid& solid_;
  ThinWallLimits limits_;
  double reach_mm_, radius_mm_;
  QueryEffort* effort_;
  double middle_z_mm_;
};

}  // namespace kerf
