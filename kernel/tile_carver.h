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

/// Carves single tiles of a block, beside the block itself: what a set of motions leaves of them.
/// What a motion removes from a column depends on the motion and the column alone, so the result is
/// to the bit what these motions, and no others, leave of the tile in a Sculpture, in any order.
/// Computes no force. Not thread-safe; several may share one start.
class TileCarver {
 public:
  /// `start`: the block with these settings before its first motion. Its tiles are shared.
  TileCarver(const SculptureSettings& settings, const SolidSnapshot& start);
  TileCarver(TileCarver&&) noexcept;
  ~TileCarver();

  /// Cuts these tiles, of existing fields and within their grids, with the swept volume of a motion
  /// that a Sculpture has accepted. `tiles` is sorted, without duplicates. `start_is_cut`: nothing
  /// of what the tool removes at the motion's first pose is left there, so that is not cut again.
  void cut(const Tool& tool, const ToolMotion& motion, std::span<const FieldTile> tiles,
           bool start_is_cut = false);
  /// Goes on with a tile as another block left it, until it is taken.
  void begin(FieldTile at, const std::shared_ptr<const DexelTile>& tile);
  /// Returns a tile as it is now; null: it is untouched stock.
  const DexelTile* find(FieldTile at) const;
  /// Returns a copy of a tile at the start, with the columns of untouched stock. The tile must not
  /// be begun.
  std::shared_ptr<DexelTile> copy_of_start(FieldTile at) const;
  /// Returns a tile as the motions since its last take() have left it, and begins it again as it
  /// was at the start; null if they have not changed it.
  std::shared_ptr<const DexelTile> take(FieldTile at);
  /// Returns a tile at the start; null: it is untouched stock.
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
