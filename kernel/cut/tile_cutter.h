// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "kernel/cut/removal.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/sweep/swept_tool.h"

namespace kerf {

/// Cuts tiles with sweeps, one tile after the other. It changes only the tiles passed to begin()
/// and its own memory, so several cutters may work on one field concurrently if their tiles are
/// disjoint.
class TileCutter {
 public:
  /// Selects a tile. All cuts of a tile must follow each other.
  void begin(DexelField& field, TileIndex tile);
  /// Cuts the tile and appends the removed elements to `removed`. The ends that move are marked
  /// with `end_code` (lazy_normals.h).
  void cut(const SweptTool& swept, NormalCode end_code, RemovedPart& removed);
  /// Stores tiles that had to be created or copied in their fields. Must be called only after all
  /// cutters of the fields have finished.
  void put_tiles();

 private:
  /// The tile being cut; `changed` is set if it may be written.
  struct Work {
    TileIndex index;
    const DexelTile* stored = nullptr;
    DexelTile* changed = nullptr;
  };
  struct Column {
    std::int32_t i, j;
  };
  struct Made {
    DexelField* field;
    TileIndex index;
    std::shared_ptr<DexelTile> tile;
  };

  void cut_block(int block);
  bool cut_by_ball(int block, Column first, unsigned rows);
  void cut_rows(Column first, unsigned rows);
  void make_editable();
  void subtract_elements(int column, Column at, Dexel cut);
  bool subtract_in_place(int column, Column at, Dexel cut);
  bool shorten(int column, Column at, Dexel cut, std::size_t lower, Dexel rest, bool top);
  bool part(int column, Column at, Dexel cut, std::size_t lower, Dexel under, Dexel over, bool top);
  void rewrite_elements(int column, Column at, Dexel cut);
  void record(Column at, Dexel removed);
  const DexelGrid& grid() const { return field_->grid(); }

  DexelField* field_ = nullptr;
  Work work_;
  const SweptTool* swept_ = nullptr;  ///< this and the next belong to the cut in progress
  RemovedPart* removed_ = nullptr;
  ColumnBlock block_;
  std::vector<std::size_t> row_groups_;  ///< groups that receive the elements removed from a row
  std::vector<Dexel> before_, after_;
  std::vector<Made> made_;
};

}  // namespace kerf
