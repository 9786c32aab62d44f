// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "kernel/dexel/solid_snapshot.h"
#include "kernel/sculpture_result.h"
#include "kernel/sculpture_settings.h"
#include "kernel/sweep/tool_motion.h"
#include "kernel/tool/tool.h"

namespace kerf {

class DexelField;
class LazyNormals;
class Removal;

/// Carves single tiles of a block by a set of motions, without changing the block. The interval
/// that a motion removes from a column depends on the motion and the column alone. So the result
/// equals, to the bit, the tile of a Sculpture that has applied exactly these motions, in any
/// order. Computes no force. Not thread-safe; several carvers may share one start.
class TileCarver {
 public:
  /// `start` is the block with these settings before its first motion. Its tiles are shared.
  TileCarver(const SculptureSettings& settings, const SolidSnapshot& start);
  TileCarver(TileCarver&&) noexcept;
  ~TileCarver();

  /// Cuts these tiles, of existing fields and within their grids, with the swept volume of a motion
  /// that a Sculpture has accepted. `tiles` is sorted, without duplicates. `start_is_cut` states
  /// that the interval of the motion's first pose has already been removed, so that it is not cut
  /// again.
  void cut(const Tool& tool, const ToolMotion& motion, std::span<const FieldTile> tiles,
           bool start_is_cut = false);
  /// Continues with a tile as another block left it, until it is taken.
  void begin(FieldTile at, const std::shared_ptr<const DexelTile>& tile);
  /// Returns a tile in its present state, or null for untouched stock.
  const DexelTile* find(FieldTile at) const;
  /// Returns a copy of a tile at the start, with the columns of untouched stock. begin() must not
  /// have been called for the tile since its last take().
  std::shared_ptr<DexelTile> copy_of_start(FieldTile at) const;
  /// Returns a tile as the motions since its last take() have left it, and resets it to the start.
  /// Returns null if they have not changed it.
  std::shared_ptr<const DexelTile> take(FieldTile at);
  /// Returns a tile at the start, or null for untouched stock.
  std::shared_ptr<const DexelTile> start(FieldTile at) const;

 private:
  struct Layer;
  Layer& layer(RayAxis axis);
  const Layer& layer(RayAxis axis) const;

  MotionModel motion_model_;
  double tolerance_mm_;
  SolidSnapshot start_;
  std::vector<Layer> layers_;  ///< of each field
  std::unique_ptr<Removal> removal_;
  std::vector<TileIndex> tiles_;  ///< of one field; reuses its memory
};

}  // namespace kerf
