// SPDX-License-Identifier: Apache-2.0
// The part of BlockHistory that finds the maker of a point of the surface.
#include "server/history/surface_maker.h"

#include <algorithm>

#include "kernel/dexel/dexel_tile.h"
#include "kernel/motion_reach.h"
#include "kernel/tile_carver.h"
#include "server/history/block_history.h"

namespace kerf {
namespace {

/// A tile with a single quantum, and cuts of it.
class LoneCell {
 public:
  LoneCell(const StockCell& cell, TileCarver& carver)
      : at_{cell.axis, {cell.i / kTileSide, cell.j / kTileSide}},
        column_(cell.j % kTileSide * kTileSide + cell.i % kTileSide),
        carver_(carver) {
    auto tile = std::make_shared<DexelTile>();
    tile->bottom.fill(0);
    tile->top.fill(0);
    const Dexel dexel{cell.depth, cell.depth + 1};
    tile->write(column_, {&dexel, 1});
    tile->update_bounds();
    tile_ = std::move(tile);
    carver_.begin(at_, tile_);
  }

  /// Whether a motion removes it.
  bool is_removed_by(const RecordedMotion& motion) {
    carver_.cut(*motion.tool, motion.motion, {&at_, 1});
    const Dexel left = carver_.find(at_)->view(column_).topmost;
    if (left.bottom != left.top) return false;
    (void)carver_.take(at_);
    carver_.begin(at_, tile_);
    return true;
  }

 private:
  FieldTile at_;
  int column_;
  TileCarver& carver_;
  std::shared_ptr<const DexelTile> tile_;
};

}  // namespace

std::expected<std::optional<SurfaceMaker>, std::string> BlockHistory::first_to_remove(
    const StockCell& cell, const MotionSet& set, const std::stop_token& stop) {
  std::optional<SurfaceMaker> maker;
  if (!was_stock(start_, cell)) return maker;
  const Bounds box = box_of(cell, grid(cell.axis), margin_mm_);
  TileCarver carver(shape_settings_, start_);
  LoneCell lone(cell, carver);
  std::uint64_t end = std::min(set.last, last()) + 1;  // end of the candidate records
  for (const MotionSpan& span : spans_.all()) {
    const MotionRun& run = span.run;
    if (run.first >= end) break;
    if (set.without.contains(run.stroke) || !span.meets(box)) continue;
    for (auto record = run.first; record <= run.last && record < end; ++record) {
      const std::uint64_t first = RecordedMotions::window_begin(record);
      const auto windows = motions_.windows({&first, 1}, stop);
      if (!windows) return std::unexpected(windows.error());
      const RecordedMotion& motion = windows->front()->motions[record - first];
      if (motion.tool == nullptr || motion.stroke != run.stroke) continue;
      if (!may_meet(*motion.tool, motion.motion, box) || !lone.is_removed_by(motion)) continue;
      const Stroke* stroke = strokes().find(motion.stroke);
      maker = {record, stroke != nullptr ? *stroke : Stroke{}, motion.motion};
      end = record;
    }
  }
  return maker;
}

}  // namespace kerf
