// SPDX-License-Identifier: Apache-2.0
#include "kernel/dexel/tile_directory.h"

#include "kernel/dexel/dexel_tile.h"

namespace kerf {
namespace {

/// Returns the node of a slot for editing. Creates it if absent, and copies it if it has an earlier
/// era and is therefore shared.
template <class Node>
Node& unshared(std::shared_ptr<Node>& slot, std::uint64_t era) {
  if (!slot) {
    slot = std::make_shared<Node>();
  } else if (slot->era != era) {
    slot = std::make_shared<Node>(*slot);
  }
  slot->era = era;
  return *slot;
}

std::int32_t roots(std::int32_t tiles, int bits) { return ((tiles - 1) >> bits) + 1; }

}  // namespace

TileDirectory::TileDirectory(std::int32_t tiles_x, std::int32_t tiles_y)
    : root_x_(roots(tiles_x, 2 * kLeafBits)), root_(std::make_shared<Root>()) {
  root_->child.resize(std::size_t(root_x_) * std::size_t(roots(tiles_y, 2 * kLeafBits)));
}

std::shared_ptr<const DexelTile> TileDirectory::share(TileIndex tile) const {
  const Leaf* leaf = leaf_of(tile);
  return leaf == nullptr ? nullptr : leaf->child[index(tile, 0)];
}

DexelTile* TileDirectory::own(TileIndex tile, std::uint64_t era) {
  // A tile of this era was stored during it, so its parent nodes are of this era too.
  DexelTile* stored = locate(tile);
  return stored != nullptr && stored->era == era ? stored : nullptr;
}

std::shared_ptr<DexelTile>& TileDirectory::slot(TileIndex tile, std::uint64_t era) {
  Root& root = unshared(root_, era);
  Branch& branch = unshared(root.child[root_index(tile)], era);
  Leaf& leaf = unshared(branch.child[index(tile, kLeafBits)], era);
  return leaf.child[index(tile, 0)];
}

std::size_t TileDirectory::bytes() const {
  std::size_t bytes = sizeof(Root) + root_->child.capacity() * sizeof(std::shared_ptr<Branch>);
  for (const auto& branch : root_->child) {
    if (!branch) continue;
    bytes += sizeof(Branch);
    for (const auto& leaf : branch->child) bytes += leaf ? sizeof(Leaf) : 0;
  }
  return bytes;
}

}  // namespace kerf
