#include "kernel/cut/cut.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "kernel/cut/subtract_row.h"

namespace kerf {
namespace {

struct ColumnRange {
  std::int32_t first, last;  ///< inclusive; empty when first > last
};

/// Columns whose ray lies in [lo, hi], one more on either side to be sure: the exact test is the
/// sweep's.
ColumnRange columns_in(double lo_mm, double hi_mm, double origin_mm, double pitch_mm,
                       std::int32_t columns) {
  const double first = std::floor((lo_mm - origin_mm) / pitch_mm - 0.5);
  const double last = std::ceil((hi_mm - origin_mm) / pitch_mm - 0.5);
  return {static_cast<std::int32_t>(std::clamp(first, 0.0, double(columns))),
          static_cast<std::int32_t>(std::clamp(last, -1.0, double(columns) - 1))};
}

SweepBounds bounds_of(const SweptTool& swept) {
  SweepBounds all{{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}};
  for (const SweptPiece& piece : swept.pieces) {
    const SweepBounds b =
        std::visit([](const auto& s) -> SweepBounds { return s.bounds(); }, piece);
    all.min_mm = {std::min(all.min_mm.x, b.min_mm.x), std::min(all.min_mm.y, b.min_mm.y),
                  std::min(all.min_mm.z, b.min_mm.z)};
    all.max_mm = {std::max(all.max_mm.x, b.max_mm.x), std::max(all.max_mm.y, b.max_mm.y),
                  std::max(all.max_mm.z, b.max_mm.z)};
  }
  return all;
}

/// One sweep at work on one field.
class Cutter {
 public:
  Cutter(DexelField& field, const SweptTool& swept, Removal& removal)
      : field_(field), grid_(field.grid()), swept_(swept), removal_(removal) {}

  void run() {
    const SweepBounds b = bounds_of(swept_);
    const double top_mm = grid_.z_mm(grid_.height_quanta);
    if (!(b.max_mm.z > grid_.origin_mm.z && b.min_mm.z < top_mm)) return;
    const ColumnRange is =
        columns_in(b.min_mm.x, b.max_mm.x, grid_.origin_mm.x, grid_.pitch_mm, grid_.columns_x);
    const ColumnRange js =
        columns_in(b.min_mm.y, b.max_mm.y, grid_.origin_mm.y, grid_.pitch_mm, grid_.columns_y);
    if (is.first > is.last || js.first > js.last) return;
    for (std::int32_t y = js.first / kTileSide; y <= js.last / kTileSide; ++y) {
      for (std::int32_t x = is.first / kTileSide; x <= is.last / kTileSide; ++x) cut_tile({x, y});
    }
  }

 private:
  /// The tile that is being cut, and whether it is ours to write already.
  struct Work {
    TileIndex index;
    const DexelTile* stored;
    DexelTile* changed = nullptr;
  };

  static Lanes lower_bound(const SweptPiece& piece, const Discs& discs) {
    Lanes z = Lanes(std::numeric_limits<double>::infinity());
    std::visit([&](const auto& s) { s.lower_bound(discs, z); }, piece);
    return z;
  }
  Lanes lower_bound(const Discs& discs) const {
    Lanes z = Lanes(std::numeric_limits<double>::infinity());
    for (const SweptPiece& piece : swept_.pieces) {
      std::visit([&](const auto& s) { s.lower_bound(discs, z); }, piece);
    }
    return z;
  }

  std::int32_t block_top(const Work& work, int block) const {
    return work.stored != nullptr ? work.stored->block_top[std::size_t(block)]
                                  : grid_.height_quanta;
  }
  /// Height that a sweep must come below to change anything under `top`.
  double reached_below_mm(std::int32_t top) const { return grid_.z_mm(top) + grid_.z_quantum_mm; }

  void cut_tile(TileIndex tile) {
    Work work{tile, field_.find(tile)};
    const std::int64_t before = removal_.quanta;
    // Two rows of four blocks are asked for at once.
    for (int block = 0; block < kTileBlocks; block += kLanes) {
      Discs discs{{}, {}, 3.5 * 1.4142135623730952 * grid_.pitch_mm};
      Lanes tops;
      for (int i = 0; i < kLanes; ++i) {
        const auto [x, y] = first_column(tile, block + i);
        discs.x_mm.set(i, grid_.x_mm(x) + 3.5 * grid_.pitch_mm);
        discs.y_mm.set(i, grid_.y_mm(y) + 3.5 * grid_.pitch_mm);
        tops.set(i, reached_below_mm(block_top(work, block + i)));
      }
      const unsigned reached = lanes_below(lower_bound(discs), tops);
      for (int i = 0; i < kLanes; ++i) {
        if ((reached >> i & 1) != 0) cut_block(work, block + i);
      }
    }
    if (removal_.quanta > before) removal_.changed_tiles.push_back(tile);
  }

  struct Column {
    std::int32_t i, j;
  };
  static Column first_column(TileIndex tile, int block) {
    return {tile.x * kTileSide + block % kTileBlocksAcross * kBlockSide,
            tile.y * kTileSide + block / kTileBlocksAcross * kBlockSide};
  }

  void cut_block(Work& work, int block) {
    const Column first = first_column(work.index, block);
    if (first.i >= grid_.columns_x || first.j >= grid_.columns_y) return;
    const std::int32_t top = block_top(work, block);
    Discs discs{Lanes(grid_.x_mm(first.i) + 3.5 * grid_.pitch_mm), {}, 3.5 * grid_.pitch_mm};
    for (int i = 0; i < kBlockSide; ++i) {
      block_.x_mm.set(i, grid_.x_mm(first.i + i));
      block_.y_mm[i] = grid_.y_mm(first.j + i);
      discs.y_mm.set(i, block_.y_mm[i]);
    }
    const std::int32_t in_grid = std::min(kBlockSide, grid_.columns_y - first.j);
    Lanes reached_below = reached_below_mm(top);
    if (work.stored != nullptr) {
      std::int32_t tops[kBlockSide];
      work.stored->row_tops(block, tops);
      for (int i = 0; i < kBlockSide; ++i) reached_below.set(i, reached_below_mm(tops[i]));
    }
    block_.top_mm = grid_.z_mm(top);
    block_.join_mm = swept_.join_mm;
    block_.clear();
    for (const SweptPiece& piece : swept_.pieces) {
      block_.lowest_mm = lower_bound(piece, discs);
      block_.rows = lanes_below(block_.lowest_mm, reached_below) & ((1U << in_grid) - 1);
      block_.leave_closed_rows();
      if (block_.rows != 0) std::visit([&](const auto& s) { s.evaluate(block_); }, piece);
    }
    if (block_.filled == 0) return;
    const std::int64_t before = removal_.quanta;
    for (int row = 0; row < kBlockSide; ++row) {
      if ((block_.filled >> row & 1) == 0) continue;
      cut_row(work, first, row, block_.lo_mm[row], block_.hi_mm[row]);
    }
    for (const ColumnBlock::Apart& a : block_.apart) {
      cut_row(work, first, a.row, a.lo_mm, a.hi_mm);
    }
    if (removal_.quanta > before) {
      work.changed->update_bounds(block);
    }
  }

  void cut_row(Work& work, Column first, int row, const Lanes& lo_mm, const Lanes& hi_mm) {
    const std::int32_t j = first.j + row;
    const int column = j % kTileSide * kTileSide + first.i % kTileSide;
    RowChange change;
    if (work.stored == nullptr) {
      // What is outside the grid or beside the stock is empty in the tile that is made.
      std::int32_t bottom[kLanes] = {}, top[kLanes];
      std::ranges::fill(top, grid_.height_quanta);
      subtract_row(lo_mm, hi_mm, grid_, bottom, top, 0, change);
      if (change.quanta == 0 && change.left_over == 0) return;
      make_editable(work);
    }
    const DexelTile& tile = *work.stored;
    const unsigned split = tile.split[std::size_t(j % kTileSide)] >> (first.i % kTileSide) & 0xFFU;
    subtract_row(lo_mm, hi_mm, grid_, &tile.bottom[std::size_t(column)],
                 &tile.top[std::size_t(column)], split, change);
    if (change.quanta > 0) {
      make_editable(work);
      std::memcpy(&work.changed->bottom[std::size_t(column)], change.bottom, sizeof change.bottom);
      std::memcpy(&work.changed->top[std::size_t(column)], change.top, sizeof change.top);
      RemovedGroup& removed = removal_.groups.emplace_back(first.i, j);
      std::memcpy(removed.bottom, change.removed_bottom, sizeof removed.bottom);
      std::memcpy(removed.top, change.removed_top, sizeof removed.top);
      removal_.quanta += change.quanta;
    }
    for (unsigned left = change.left_over; left != 0; left &= left - 1) {
      const int c = std::countr_zero(left);
      subtract_elements(work, column + c, {first.i + c, j},
                        {change.cut_bottom[c], change.cut_top[c]});
    }
  }

  void make_editable(Work& work) {
    if (work.changed != nullptr) return;
    work.changed = &field_.edit(work.index);
    work.stored = work.changed;
  }

  /// Columns of several elements, and those that the cut divides.
  void subtract_elements(Work& work, int column, Column at, Dexel cut) {
    work.stored->read(column, before_);
    after_.clear();
    bool any = false;
    for (const Dexel& d : before_) {
      const std::int32_t lo = std::max(d.bottom, cut.bottom), hi = std::min(d.top, cut.top);
      if (lo >= hi) {
        after_.push_back(d);
        continue;
      }
      any = true;
      note(at, {lo, hi});
      if (d.bottom < lo) after_.push_back({d.bottom, lo});
      if (hi < d.top) after_.push_back({hi, d.top});
    }
    if (!any) return;
    make_editable(work);
    work.changed->write(column, after_);
  }

  void note(Column at, Dexel removed) {
    const std::int32_t lane = at.i % kLanes;
    std::vector<RemovedGroup>& groups = removal_.groups;
    if (groups.empty() || groups.back().i != at.i - lane || groups.back().j != at.j ||
        groups.back().bottom[lane] < groups.back().top[lane]) {
      groups.push_back({at.i - lane, at.j, {}, {}});
    }
    groups.back().bottom[lane] = removed.bottom;
    groups.back().top[lane] = removed.top;
    removal_.quanta += removed.top - removed.bottom;
  }

  DexelField& field_;
  const DexelGrid& grid_;
  const SweptTool& swept_;
  Removal& removal_;
  ColumnBlock block_;
  std::vector<Dexel> before_, after_;
};

}  // namespace

void cut(DexelField& field, const SweptTool& swept, Removal& removal) {
  removal.clear();
  if (!swept.pieces.empty()) Cutter(field, swept, removal).run();
}

}  // namespace kerf
