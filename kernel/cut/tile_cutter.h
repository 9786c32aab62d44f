// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "kernel/cut/removal.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/sweep/swept_tool.h"

namespace kerf {

/// A tile that a sweep may change, found before the sweep is evaluated.
struct ReachedTile {
  TileIndex index;
  const DexelTile* stored;  ///< null if it is untouched
  unsigned blocks;          ///< bit b: the sweep reaches below the top of block b
};

/// Cuts tiles of one field with one sweep. It changes only the tiles passed to cut() and its own
/// memory, so several cutters may work on one field concurrently if their tiles are disjoint.
class TileCutter {
 public:
  /// `end_code`: as in cut().
  TileCutter(DexelField& field, const SweptTool& swept, NormalCode end_code, RemovedPart& removed)
      : field_(field), grid_(field.grid()), swept_(swept), end_code_(end_code), removed_(removed) {}

  /// Cuts one tile and appends what was removed to `removed`.
  void cut(const ReachedTile& tile);
  /// Stores in the field the tiles that had to be made or copied. Only after all cutters of the
  /// field have finished.
  void put_tiles();

 private:
  /// The tile being cut; `changed` is set once it may be written.
  struct Work {
    TileIndex index;
    const DexelTile* stored;
    DexelTile* changed = nullptr;
  };
  struct Column {
    std::int32_t i, j;
  };
  struct Made {
    TileIndex index;
    std::shared_ptr<DexelTile> tile;
  };

  void cut_block(Work& work, int block);
  void cut_rows(Work& work, Column first, unsigned rows);
  void make_editable(Work& work);
  void subtract_elements(Work& work, int column, Column at, Dexel cut);
  bool subtract_in_place(Work& work, int column, Column at, Dexel cut);
  bool shorten(Work& work, int column, Column at, Dexel cut, std::size_t lower, bool top);
  bool part(Work& work, int column, Column at, Dexel cut, std::size_t lower, bool top);
  void rewrite_elements(Work& work, int column, Column at, Dexel cut);
  void record(Column at, Dexel removed);

  DexelField& field_;
  const DexelGrid& grid_;
  const SweptTool& swept_;
  NormalCode end_code_;
  RemovedPart& removed_;
  ColumnBlock block_;
  std::vector<std::size_t> row_groups_;  ///< groups that receive the elements removed from a row
  std::vector<Dexel> before_, after_;
  std::vector<Made> made_;
};

}  // namespace kerf
