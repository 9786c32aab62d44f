// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "kernel/dexel/tile_index.h"

namespace kerf {

struct DexelTile;

/// The touched tiles of a field, in a copy-on-write tree of three levels: nodes of 16 x 16 children
/// below a root with one child per 8192 x 8192 columns. Untouched parts of the block have no nodes.
/// A copy of the directory shares all nodes. Nodes and tiles carry their owner's era at the time of
/// creation. Those of an earlier era are shared, and are copied before they are changed.
class TileDirectory {
 public:
  TileDirectory(std::int32_t tiles_x, std::int32_t tiles_y);

  /// Returns a tile, or null while it is untouched. It must be in the grid.
  const DexelTile* find(TileIndex tile) const { return locate(tile); }
  /// Returns a tile to be shared, or null while it is untouched.
  std::shared_ptr<const DexelTile> share(TileIndex tile) const;
  /// Returns a tile for editing if it is of this era, hence not shared with a copy, or null.
  DexelTile* own(TileIndex tile, std::uint64_t era);
  /// Returns the slot of a tile, to be filled or replaced. Creates or copies the nodes on its path.
  /// `era` must not decrease from call to call.
  std::shared_ptr<DexelTile>& slot(TileIndex tile, std::uint64_t era);

  /// Calls visit(TileIndex, const DexelTile&) for every touched tile, in an order that depends only
  /// on the tiles' indices.
  template <class Visit>
  void for_each(Visit&& visit) const {
    for (std::size_t r = 0; r < root_->child.size(); ++r) {
      const Branch* branch = root_->child[r].get();
      if (branch == nullptr) continue;
      const TileIndex at{static_cast<std::int32_t>(r % std::size_t(root_x_)) << (2 * kLeafBits),
                         static_cast<std::int32_t>(r / std::size_t(root_x_)) << (2 * kLeafBits)};
      for (std::size_t b = 0; b < kChildren; ++b) {
        if (branch->child[b]) visit_leaf(*branch->child[b], moved(at, b, kLeafBits), visit);
      }
    }
  }
  /// Returns the newest era in which a slot was filled. No node has a later one.
  std::uint64_t era() const { return root_->era; }
  /// Returns the bytes of the nodes, without the tiles.
  std::size_t bytes() const;

 private:
  static constexpr int kLeafBits = 4;
  static constexpr std::size_t kChildren = std::size_t{1} << (2 * kLeafBits);
  template <class Child>
  struct Node {
    std::uint64_t era = 0;
    std::array<std::shared_ptr<Child>, kChildren> child;
  };
  using Leaf = Node<DexelTile>;
  using Branch = Node<Leaf>;
  struct Root {
    std::uint64_t era = 0;
    std::vector<std::shared_ptr<Branch>> child;  ///< row-major
  };

  static std::size_t index(TileIndex tile, int shift) {
    constexpr std::int32_t kMask = (1 << kLeafBits) - 1;
    return std::size_t(((tile.y >> shift) & kMask) << kLeafBits | ((tile.x >> shift) & kMask));
  }
  static TileIndex moved(TileIndex at, std::size_t child, int shift) {
    constexpr std::size_t kMask = (std::size_t{1} << kLeafBits) - 1;
    return {at.x + (static_cast<std::int32_t>(child & kMask) << shift),
            at.y + (static_cast<std::int32_t>(child >> kLeafBits) << shift)};
  }
  /// Returns the leaf that holds a tile, or null.
  const Leaf* leaf_of(TileIndex tile) const {
    const Branch* branch = root_->child[root_index(tile)].get();
    return branch == nullptr ? nullptr : branch->child[index(tile, kLeafBits)].get();
  }
  DexelTile* locate(TileIndex tile) const {
    const Leaf* leaf = leaf_of(tile);
    return leaf == nullptr ? nullptr : leaf->child[index(tile, 0)].get();
  }
  std::size_t root_index(TileIndex tile) const {
    return std::size_t(tile.y >> (2 * kLeafBits)) * std::size_t(root_x_) +
           std::size_t(tile.x >> (2 * kLeafBits));
  }
  template <class Visit>
  static void visit_leaf(const Leaf& leaf, TileIndex at, Visit& visit) {
    for (std::size_t c = 0; c < kChildren; ++c) {
      if (leaf.child[c]) visit(moved(at, c, 0), std::as_const(*leaf.child[c]));
    }
  }

  std::int32_t root_x_;
  std::shared_ptr<Root> root_;
};

}  // namespace kerf
