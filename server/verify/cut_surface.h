// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "server/verify/true_solid.h"

namespace kerf {

/// A point of the true solid's surface: cut by a tool, or of the stock mesh.
struct CutPoint {
  Vec3 mm;
  Vec3 into_solid;      ///< unit normal, out of the tool
  std::uint32_t sweep;  ///< motion that cut it; number of motions: the stock's
  double share = 0;     ///< fraction of the motion at which the tool touches it
};

/// Points spread over the surface of a solid.
struct CutSurface {
  std::vector<CutPoint> points;
  /// Mean distance of the candidates on the swept surfaces, mm: the root of their area per
  /// candidate. A part of the surface smaller than that in both directions may have no point.
  double spacing_mm = 0;
};

/// Samples the surface of a solid. Spreads `candidates` points evenly by area over the surfaces
/// that the tools sweep inside the stock (along a motion where the normal is perpendicular to the
/// point's velocity, and at its ends), and keeps those that no other motion removes. The sequence
/// is fixed, so equal solids give equal points. With several tools half of the points are shared by
/// area and half equally, because a small tool cuts little. If the stock is a mesh, as many points
/// are spread over the mesh; none over a box or cylinder, whose faces are wide. Ends early, with
/// fewer points and a greater spacing, if a stop is requested or `effort` is spent.
CutSurface sample_cut_surface(const TrueSolid& solid, std::size_t candidates,
                              const std::stop_token& stop = {}, QueryEffort* effort = nullptr);

}  // namespace kerf
