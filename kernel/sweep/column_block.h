// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "kernel/math/lanes.h"
#include "kernel/math/tolerance.h"
#include "kernel/math/vec3.h"

namespace kerf {

/// Rows of a block; each row is one group of eight columns.
inline constexpr int kBlockSide = kLanes;

/// The discs (bit i: disc i) over which a piece of the tool has nothing left to remove, because its
/// first pose has already been removed.
struct LeftOut {
  unsigned behind = 0;  ///< the piece moves away from them; no lower bound was computed
  unsigned gone = 0;    ///< they are inside its first pose over its whole height
  /// The exposed surface of the piece moves away from them, so points enter the piece there only
  /// through a disc that a neighbor hides. Includes `behind`.
  unsigned shown_behind = 0;
};

/// Lower bounds of the heights that a piece of the tool removes within eight discs.
struct PieceBounds {
  Lanes lowest_mm = Lanes(std::numeric_limits<double>::infinity());
  LeftOut left_out = {};
  unsigned reached = 0;  ///< discs (bit i: disc i) over which there is stock above the bound

  /// Returns the discs over which the piece may change the stock.
  unsigned changed() const { return reached & ~left_out.gone; }
};

/// The discs over which a tool may change the stock: those that one of its pieces reaches, unless
/// it is the only one there and its exposed surface moves away (kernel/sweep/bounds.md, "The tool
/// as a whole").
class ToolReach {
 public:
  /// `near` has the discs over which the piece is low enough to close a gap.
  void add(const PieceBounds& piece, unsigned near) {
    several_ |= near & near_;
    near_ |= near;
    changed_ |= piece.changed();
    advances_ |= piece.changed() & ~piece.left_out.shown_behind;
  }
  unsigned discs() const { return changed_ & (advances_ | several_); }

 private:
  unsigned changed_ = 0, advances_ = 0, several_ = 0, near_ = 0;
};

/// A block of 8 x 8 columns, and the intervals of heights that a sweep removes from them: the unit
/// of work. Most columns lose one interval. Further intervals that do not join it are in `apart`.
struct ColumnBlock {
  /// Further intervals of a row.
  struct Apart {
    int row;
    Lanes lo_mm, hi_mm;
  };

  Lanes x_mm;               ///< of the columns, equal in every row
  double y_mm[kBlockSide];  ///< of the rows
  unsigned rows = 0;        ///< bit r: row r must be evaluated
  double join_mm = 0;       ///< intervals of a column at most this far apart are joined
  double top_mm = 0;        ///< upper bound of the stock; ends above it need not be exact
  double grid_top_mm = 0;   ///< top of the grid, which no stock exceeds
  /// Per column, the heights that enclose all of its stock. Ends beyond them need not be exact. lo
  /// ≥ hi if it has none.
  std::array<Lanes, kBlockSide> stock_lo_mm = every_row(-std::numeric_limits<double>::infinity());
  std::array<Lanes, kBlockSide> stock_hi_mm = every_row(std::numeric_limits<double>::infinity());
  Lanes lo_mm[kBlockSide];   ///< out: lower end of the interval; +inf where nothing is removed
  Lanes hi_mm[kBlockSide];   ///< out: upper end of the interval; −inf where nothing is removed
  std::vector<Apart> apart;  ///< out: further intervals; empty lanes have lo > hi

  Lanes lowest_mm;  ///< per row, a lower bound of the heights that the evaluated piece removes
  /// Bit r: in row r the piece below, or above, the evaluated one is not left out as behind the
  /// tool, so it removes the points that pass into it through a common disc.
  unsigned below_is_swept = 0xFF, above_is_swept = 0xFF;
  /// Bit r: in row r the columns `raised[r]` lose everything above a point that the evaluated piece
  /// removes (ToolAbove).
  unsigned raised_rows = 0;
  LaneMask raised[kBlockSide];
  unsigned filled = 0;  ///< bit r: row r holds intervals
  /// Number of evaluations of eight rays within a stretch, without those of the search: the work
  /// beyond that of a motion's own stations. Only added to.
  std::int64_t stations = 0;
  std::vector<PieceBounds> bounds;  ///< per piece of the tool, in the rows (sweep_block)

  /// Empties all rows.
  void clear() {
    filled = 0;
    apart.clear();
  }

  /// Returns the columns of a row that have not yet lost everything above `lowest_mm`. The
  /// evaluated piece can change only these.
  KERF_INLINE LaneMask open(int row) const {
    if ((filled >> row & 1) == 0) return every_lane();
    return (lo_mm[row] > lowest_mm[row]) | (hi_mm[row] < top_mm);
  }
  /// Returns the columns of a row in which no upper end matters.
  KERF_INLINE LaneMask loses_all_above(int row) const {
    return (raised_rows >> row & 1) != 0 ? raised[row] : ~every_lane();
  }
  /// Removes rows without an open column from `rows`.
  void drop_closed_rows();

  /// Adds the interval [lo, hi] (empty where lo > hi) to the columns of a row. Intervals that are
  /// no farther apart than join_mm are joined, transitively, so that no sliver remains where two
  /// pieces of a tool meet. The result does not depend on the order of the intervals
  /// (kernel/sweep/bounds.md, "Joining"). Intervals that are farther above the stock are ignored.
  KERF_INLINE void add(int row, Lanes lo, Lanes hi) {
    const LaneMask adds = (lo <= hi) & (lo < top_mm + join_mm);
    if ((raised_rows >> row & 1) != 0) {
      hi = select(raised[row] & (hi < grid_top_mm), Lanes(grid_top_mm), hi);
    }
    if ((filled >> row & 1) == 0) {
      const Lanes none = std::numeric_limits<double>::infinity();
      filled |= 1U << row;
      lo_mm[row] = select(adds, lo, none);
      hi_mm[row] = select(adds, hi, -none);
      return;
    }
    if (!apart.empty()) return add_among(row, adds, lo, hi);
    const Lanes present_lo = lo_mm[row], present_hi = hi_mm[row];
    const LaneMask joins = adds & ((present_lo > present_hi) |
                                   ((lo <= present_hi + join_mm) & (present_lo <= hi + join_mm)));
    lo_mm[row] = select(joins & (lo < present_lo), lo, present_lo);
    hi_mm[row] = select(joins & (hi > present_hi), hi, present_hi);
    const LaneMask stays_apart = adds & ~joins;
    if (any(stays_apart)) keep_apart(row, stays_apart, lo, hi);
  }

 private:
  static std::array<Lanes, kBlockSide> every_row(double mm) {
    std::array<Lanes, kBlockSide> rows;
    rows.fill(Lanes(mm));
    return rows;
  }
  void add_among(int row, const LaneMask& adds, const Lanes& lo, const Lanes& hi);
  void keep_apart(int row, const LaneMask& which, const Lanes& lo, const Lanes& hi);
};

/// Returns a mask whose bit i is set where lane i of a is less than lane i of b.
unsigned lanes_below(const Lanes& a, const Lanes& b);

/// Box around a swept piece (mm). Nothing outside is removed.
struct SweepBounds {
  Vec3 min_mm, max_mm;
};

/// Eight discs in the XY plane with the common radius `reach_mm`, for which a sweep computes lower
/// bounds. Parts of the stock below these bounds are skipped.
struct Discs {
  Lanes x_mm, y_mm;
  double reach_mm;
};

}  // namespace kerf
