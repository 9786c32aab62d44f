// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "kernel/cut/removal.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/sweep/swept_tool.h"

namespace kerf {

/// A tile that a sweep may change: what is known of it before anything is evaluated.
struct ReachedTile {
  TileIndex index;
  const DexelTile* stored;  ///< null while it is untouched
  unsigned blocks;          ///< bit b: the sweep comes below the top of the tile's block b
};

/// Cuts tiles of one field with one sweep. It changes nothing but the tiles that it is given and
/// its own memory, so several of them may work on one field at the same time, each on tiles of its
/// own.
class TileCutter {
 public:
  /// `end_code`: as in cut().
  TileCutter(DexelField& field, const SweptTool& swept, NormalCode end_code, RemovedPart& removed)
      : field_(field), grid_(field.grid()), swept_(swept), end_code_(end_code), removed_(removed) {}

  void cut(const ReachedTile& tile);
  /// Puts the tiles that had to be made or copied into the field: when all others have ended.
  void put_tiles();

 private:
  /// The tile that is being cut, and whether it is ours to write already.
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
  void sweep_block(const Work& work, int block, Column first);
  void cut_rows(Work& work, Column first, unsigned rows);
  void make_editable(Work& work);
  void subtract_elements(Work& work, int column, Column at, Dexel cut);
  bool subtract_in_place(Work& work, int column, Column at, Dexel cut);
  void rewrite_elements(Work& work, int column, Column at, Dexel cut);
  void note(Column at, Dexel removed);

  DexelField& field_;
  const DexelGrid& grid_;
  const SweptTool& swept_;
  NormalCode end_code_;
  RemovedPart& removed_;
  ColumnBlock block_;
  static constexpr std::size_t kNoGroup = ~std::size_t{0};
  std::size_t group_ = kNoGroup;  ///< in which what a row loses is noted
  std::vector<Dexel> before_, after_;
  std::vector<Made> made_;
};

}  // namespace kerf
