#include "kernel/cut/cut.h"

#include <algorithm>
#include <cmath>

namespace kerf {
namespace {

/// The depths to be removed from each column of a row, in quanta; bottom >= top: nothing.
struct CutRow {
  std::int32_t bottom[kTileSide];
  std::int32_t top[kTileSide];
};

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

KERF_VECTOR_CLONES
void quantize(const ColumnRow& row, double origin_z, double inverse_quantum, double height,
              CutRow& out) {
  for (int i = 0; i < row.lanes; ++i) {
    double lo = (row.lo_mm[i] - origin_z) * inverse_quantum;
    double hi = (row.hi_mm[i] - origin_z) * inverse_quantum;
    lo = lo > 0 ? lo : 0;
    hi = hi > 0 ? hi : 0;
    lo = lo < height ? lo : height;
    hi = hi < height ? hi : height;
    out.bottom[i] = static_cast<std::int32_t>(lo + 0.5);
    out.top[i] = static_cast<std::int32_t>(hi + 0.5);
  }
}

/// The part of a run in which the stock reaches above the plane that bounds the sweep from below.
ColumnRange reaching_above(const LowerPlane& plane, const ColumnRow& row, const std::int32_t* top,
                           double origin_z, double quantum) {
  ColumnRange range{0, row.count - 1};
  const double at_row = plane.at_origin_mm + plane.by_y * row.y_mm - origin_z - quantum;
  const auto is_below = [&](std::int32_t c) {
    return top[c] * quantum <= at_row + plane.by_x * row.x_mm[c];
  };
  while (range.first <= range.last && is_below(range.first)) ++range.first;
  while (range.last > range.first && is_below(range.last)) --range.last;
  return range;
}

/// Whether the cut overlaps the topmost element of any of the columns.
KERF_VECTOR_CLONES
bool overlaps(const CutRow& cut, const std::int32_t* bottom, const std::int32_t* top, int count) {
  std::int32_t any = 0;
  for (int i = 0; i < count; ++i) {
    const std::int32_t lo = cut.bottom[i] > bottom[i] ? cut.bottom[i] : bottom[i];
    const std::int32_t hi = cut.top[i] < top[i] ? cut.top[i] : top[i];
    any |= lo < hi;
  }
  return any != 0;
}

/// One sweep at work on one field.
class Cutter {
 public:
  Cutter(DexelField& field, const SweptPiece& swept, Removal& removal)
      : field_(field), grid_(field.grid()), swept_(swept), removal_(removal) {}

  void run() {
    const SweepBounds b = std::visit([](const auto& s) { return s.bounds(); }, swept_);
    const double top_mm = grid_.z_mm(grid_.height_quanta);
    if (!(b.max_mm.z > grid_.origin_mm.z && b.min_mm.z < top_mm)) return;
    plane_ = std::visit([](const auto& s) { return s.lower_plane(); }, swept_);
    lowest_ = (b.min_mm.z - grid_.origin_mm.z) / grid_.z_quantum_mm - 1;
    const ColumnRange is =
        columns_in(b.min_mm.x, b.max_mm.x, grid_.origin_mm.x, grid_.pitch_mm, grid_.columns_x);
    rows_ = columns_in(b.min_mm.y, b.max_mm.y, grid_.origin_mm.y, grid_.pitch_mm, grid_.columns_y);
    if (is.first > is.last || rows_.first > rows_.last) return;
    for (std::int32_t y = rows_.first / kTileSide; y <= rows_.last / kTileSide; ++y) {
      for (std::int32_t x = is.first / kTileSide; x <= is.last / kTileSide; ++x) cut_tile({x, y});
    }
  }

 private:
  void cut_tile(TileIndex tile) {
    const DexelTile* stored = field_.find(tile);
    if (stored != nullptr && stored->top_max <= lowest_) return;
    DexelTile* changed = nullptr;
    const std::int32_t first = std::max(rows_.first, tile.y * kTileSide);
    const std::int32_t last = std::min(rows_.last, tile.y * kTileSide + kTileSide - 1);
    for (std::int32_t j = first; j <= last; ++j) cut_row(tile, j, changed);
    if (changed == nullptr) return;
    changed->update_bounds();
    removal_.changed_tiles.push_back(tile);
  }

  void cut_row(TileIndex tile, std::int32_t j, DexelTile*& changed) {
    ColumnRow row;
    row.y_mm = grid_.y_mm(j);
    const XRange x = std::visit([&](const auto& s) { return s.row_range(row.y_mm); }, swept_);
    if (!(x.lo_mm <= x.hi_mm)) return;
    const ColumnRange is =
        columns_in(x.lo_mm, x.hi_mm, grid_.origin_mm.x, grid_.pitch_mm, grid_.columns_x);
    std::int32_t first = std::max(is.first, tile.x * kTileSide);
    const std::int32_t last = std::min(is.last, tile.x * kTileSide + kTileSide - 1);
    if (first > last) return;
    const DexelTile* stored = changed != nullptr ? changed : field_.find(tile);
    if (!fill_row(row, first, last, j, stored)) return;
    std::visit([&](const auto& s) { s.evaluate(row); }, swept_);
    CutRow cut;
    quantize(row, grid_.origin_mm.z, 1 / grid_.z_quantum_mm, grid_.height_quanta, cut);

    const int column = (j % kTileSide) * kTileSide + first % kTileSide;
    if (!hits(stored, column, cut, row.count)) return;
    if (changed == nullptr) {
      const std::int64_t before = removal_.quanta;
      DexelTile& made = field_.edit(tile);
      apply(made, column, first, j, cut, row.count);
      // The empty corners beside a cylinder may have looked like a hit.
      if (removal_.quanta > before) changed = &made;
    } else {
      apply(*changed, column, first, j, cut, row.count);
    }
  }

  /// Puts the columns first..last of row j into `row`, less those at its ends whose stock is below
  /// the sweep; `first` is moved accordingly. False if none is left.
  bool fill_row(ColumnRow& row, std::int32_t& first, std::int32_t last, std::int32_t j,
                const DexelTile* stored) const {
    row.assign(last - first + 1, [&](int c) { return grid_.x_mm(first + c); });
    if (stored == nullptr) return true;
    const std::int32_t* top =
        &stored->top[std::size_t((j % kTileSide) * kTileSide + first % kTileSide)];
    const ColumnRange left =
        reaching_above(plane_, row, top, grid_.origin_mm.z, grid_.z_quantum_mm);
    if (left.first > left.last) return false;
    first += left.first;
    row.assign(left.last - left.first + 1, [&](int c) { return grid_.x_mm(first + c); });
    return true;
  }

  /// Whether the cut may change a column of the run: exact for columns of one element, generous for
  /// split ones.
  bool hits(const DexelTile* tile, int column, const CutRow& cut, int count) const {
    if (tile == nullptr) {
      for (int i = 0; i < count; ++i) {
        if (cut.bottom[i] < cut.top[i]) return true;
      }
      return false;
    }
    return tile->split[std::size_t(column / kTileSide)] != 0 ||
           overlaps(cut, &tile->bottom[std::size_t(column)], &tile->top[std::size_t(column)],
                    count);
  }

  void apply(DexelTile& tile, int column, std::int32_t i, std::int32_t j, const CutRow& cut,
             int count) {
    for (int c = 0; c < count; ++c) {
      const Dexel removed{cut.bottom[c], cut.top[c]};
      if (removed.bottom >= removed.top) continue;
      if (tile.is_split(column + c)) {
        subtract_from_many(tile, column + c, i + c, j, removed);
      } else {
        subtract_from_one(tile, column + c, i + c, j, removed);
      }
    }
  }

  void subtract_from_one(DexelTile& tile, int column, std::int32_t i, std::int32_t j, Dexel cut) {
    std::int32_t& bottom = tile.bottom[std::size_t(column)];
    std::int32_t& top = tile.top[std::size_t(column)];
    const std::int32_t lo = std::max(bottom, cut.bottom), hi = std::min(top, cut.top);
    if (lo >= hi) return;
    note(i, j, {lo, hi});
    if (lo == bottom && hi == top) {
      bottom = top = 0;
    } else if (hi == top) {
      top = lo;
    } else if (lo == bottom) {
      bottom = hi;
    } else {
      const Dexel parts[] = {{bottom, lo}, {hi, top}};
      tile.write(column, parts);
    }
  }

  void subtract_from_many(DexelTile& tile, int column, std::int32_t i, std::int32_t j, Dexel cut) {
    tile.read(column, before_);
    after_.clear();
    bool any = false;
    for (const Dexel& d : before_) {
      const std::int32_t lo = std::max(d.bottom, cut.bottom), hi = std::min(d.top, cut.top);
      if (lo >= hi) {
        after_.push_back(d);
        continue;
      }
      any = true;
      note(i, j, {lo, hi});
      if (d.bottom < lo) after_.push_back({d.bottom, lo});
      if (hi < d.top) after_.push_back({hi, d.top});
    }
    if (any) tile.write(column, after_);
  }

  void note(std::int32_t i, std::int32_t j, Dexel d) {
    const std::int32_t lane = i % RemovedGroup::kLanes;
    const std::int32_t first = i - lane;
    std::vector<RemovedGroup>& groups = removal_.groups;
    if (groups.empty() || groups.back().i != first || groups.back().j != j ||
        groups.back().bottom[lane] < groups.back().top[lane]) {
      groups.push_back({first, j, {}, {}});
    }
    groups.back().bottom[lane] = d.bottom;
    groups.back().top[lane] = d.top;
    removal_.quanta += d.top - d.bottom;
  }

  DexelField& field_;
  const DexelGrid& grid_;
  const SweptPiece& swept_;
  Removal& removal_;
  ColumnRange rows_{0, -1};
  double lowest_ = 0;  ///< no sweep below this depth
  LowerPlane plane_{};
  std::vector<Dexel> before_, after_;
};

}  // namespace

void cut(DexelField& field, const SweptPiece& swept, Removal& removal) {
  removal.clear();
  Cutter(field, swept, removal).run();
}

}  // namespace kerf
