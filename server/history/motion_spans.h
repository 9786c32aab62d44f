// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernel/dexel/dexel_grid.h"
#include "kernel/piece/bounds.h"
#include "server/history/stroke_table.h"

namespace kerf {

/// Motions of one stroke: those among the records first … last, which may include other records.
struct MotionRun {
  StrokeId stroke = 0;
  std::uint64_t first = 0, last = 0;
  friend bool operator==(const MotionRun&, const MotionRun&) = default;
};

/// Whether two boxes have a point in common.
inline bool meets(const Bounds& a, const Bounds& b) {
  return a.lo_mm.x <= b.hi_mm.x && a.hi_mm.x >= b.lo_mm.x &&  //
         a.lo_mm.y <= b.hi_mm.y && a.hi_mm.y >= b.lo_mm.y &&  //
         a.lo_mm.z <= b.hi_mm.z && a.hi_mm.z >= b.lo_mm.z;
}

/// A run of motions and a box around their sweep, mm.
struct MotionSpan {
  MotionRun run;
  std::array<float, 3> lo_mm{}, hi_mm{};

  Bounds bounds() const {
    return {{double(lo_mm[0]), double(lo_mm[1]), double(lo_mm[2])},
            {double(hi_mm[0]), double(hi_mm[1]), double(hi_mm[2])}};
  }
  bool meets(const Bounds& box) const { return kerf::meets(bounds(), box); }
};

/// Index of the motions of a journal: boxes around short runs of them, searched linearly.
class MotionSpans {
 public:
  /// Most motions of a span.
  static constexpr int kMotionsMax = 64;
  /// Most foreign records between two of its motions.
  static constexpr std::uint64_t kGap = 64;

  /// A span is at most `growth_mm` longer, along each axis, than its first motion.
  explicit MotionSpans(double growth_mm) : growth_mm_(growth_mm) {}

  /// Adds a motion with a box around its sweep. Records ascend.
  void add(std::uint64_t record, StrokeId stroke, const Bounds& box);
  /// All spans, in the order of their first records. A later motion may extend one.
  std::span<const MotionSpan> all() const { return spans_; }
  std::size_t bytes() const { return spans_.capacity() * sizeof(MotionSpan); }

 private:
  /// The last span of a stroke, which may be extended.
  struct Open {
    StrokeId stroke;
    std::size_t span;
    int motions;
    std::array<double, 3> most_mm;  ///< greatest lengths allowed
  };
  bool extend(Open& open, std::uint64_t record, const Bounds& box);

  double growth_mm_;
  std::vector<MotionSpan> spans_;
  std::vector<Open> open_;  ///< the last one is the one extended last
};

/// Returns the box of the rays of a tile, in world coordinates, mm.
Bounds tile_bounds(const DexelGrid& grid, TileIndex tile);

}  // namespace kerf
