// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kernel/dexel/solid_snapshot.h"
#include "kernel/surface/column_window.h"
#include "kernel/surface/face_lattice.h"

namespace kerf {

/// The parts of the stock's flat faces that no cut has reached, as quadtrees of patches: all six
/// faces of a box, top and bottom of a cylinder. A patch is covered if all its vertices are at
/// their positions on the untouched stock. Covered patches form squares that grow with the distance
/// from the nearest uncovered patch, so their number is proportional to the carved border and to
/// the logarithm of the block's size. Construction reads touched tiles only.
class FaceCover {
 public:
  explicit FaceCover(const SolidSnapshot& solid);

  /// Returns the numbers of quadrangles along the axes: columns in x and y, samples in z.
  const LatticePoint& quads() const { return quads_; }
  const LatticePoint& patches() const { return patches_; }

  /// Returns whether patch (u, v) is covered. It must exist.
  bool covers(StockFace face, std::int32_t u, std::int32_t v) const {
    return is_square(face, {0, u, v});
  }
  /// Returns the level of the square that patch (u, v) belongs to, or -1 if it is not covered.
  int level_at(StockFace face, std::int32_t u, std::int32_t v) const;
  /// Calls square(face, node) for every square, and open(face, u, v) for every uncovered patch, on
  /// all faces. Visits only nodes that contain one of these.
  template <class Square, class Open>
  void for_each(Square&& square, Open&& open) const {
    for (const StockFace face : kStockFaces) {
      if (active_[face.index()]) descend(face, {root_level(face), 0, 0}, square, open);
    }
  }
  /// Returns whether a face has squares or open patches. The side of a cylinder has none.
  bool is_active(StockFace face) const { return active_[face.index()]; }

 private:
  template <class Square, class Open>
  void descend(StockFace face, const FaceNode& node, Square& square, Open& open) const {
    if (node.range(face, patches_).is_empty()) return;
    if (is_square(face, node)) return square(face, node);
    if (node.level == 0) return open(face, node.u, node.v);
    for (std::int32_t child = 0; child < 4; ++child) {
      descend(face, {node.level - 1, 2 * node.u + child % 2, 2 * node.v + child / 2}, square, open);
    }
  }
  int root_level(StockFace face) const;
  bool is_square(StockFace face, const FaceNode& node) const;
  bool is_cut(const FaceRange& patches, int level) const;

  void read_columns(const SolidSnapshot& solid);
  void read_sides(const SolidSnapshot& solid, TileIndex tile);
  void read_side_column(const ColumnWindow& column, std::int32_t i, std::int32_t j,
                        std::vector<bool>& cut) const;
  void read_rays(const DexelSnapshot& field);
  void block_outside(const CylinderStock& stock, const DexelGrid& grid);
  void block(StockFace face, std::int32_t u, std::int32_t v);

  LatticePoint quads_{}, patches_{};
  std::array<bool, 6> active_{};
  /// Uncovered patches, by face, as sorted Morton codes, so that those of a node are contiguous.
  std::array<std::vector<std::uint64_t>, 6> blocked_;
};

}  // namespace kerf
