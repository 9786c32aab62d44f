// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "kernel/dexel/solid_snapshot.h"
#include "kernel/surface/face_cover.h"
#include "kernel/surface/tile_mesh.h"

namespace kerf {

/// Triangulates squares of covered patches. The rim of a square keeps the vertices of adjacent
/// squares and open patches, with equal bits, so that the surface stays closed.
class FaceFan {
 public:
  /// Both must outlive this object.
  FaceFan(const SolidSnapshot& solid, const FaceCover& cover);

  /// Appends a square to a mesh: two triangles, or a fan about its center if its rim has more than
  /// four vertices.
  void append(StockFace face, const FaceNode& node, TileMesh& mesh);

 private:
  using Position = std::array<float, 3>;
  void append_side(const FaceRange& square, std::size_t along, bool high, bool backwards);
  Position position(const LatticePoint& vertex);

  const SolidSnapshot& solid_;
  const FaceCover& cover_;
  double low_z_;  ///< height of vertex 0 if it were in the middle, in pitches
  std::vector<LatticePoint> rim_;
  /// One placed vertex for each combination of low end, middle and high end along the three axes.
  /// Vertices with the same combination differ only in coordinates along which they are in the
  /// middle, by whole pitches.
  std::array<std::optional<Position>, 27> placed_;
};

}  // namespace kerf
