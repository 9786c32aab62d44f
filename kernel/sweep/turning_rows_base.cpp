// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/turning_rows.h"

namespace kerf {
namespace {

/// A side for which `meet` is called, not inlined. Without vector registers of four doubles `meet`
/// is so long that its nine inlined copies take a minute to compile, and run slower.
template <class Side>
struct OutOfLine {
  const Side& side;
};

template <End end, class Side>
[[gnu::noinline]] Meeting meet(const OutOfLine<Side>& outer, const SlicePath& path, const Lanes& x,
                               const Lanes& y, const Lanes& share) {
  return kerf::meet<end>(outer.side, path, x, y, share);
}

[[maybe_unused]] KERF_INLINE void evaluate_cone_in_lanes(const ConeSide& side,
                                                         const SlicePath& path,
                                                         ColumnBlock& block) {
  evaluate_rows(OutOfLine<ConeSide>{side}, path, block);
}
[[maybe_unused]] KERF_INLINE void evaluate_arc_in_lanes(const ArcSide& side, const SlicePath& path,
                                                        ColumnBlock& block) {
  evaluate_rows(OutOfLine<ArcSide>{side}, path, block);
}

}  // namespace

KERF_FOR_BASE_TARGET(void, evaluate_cone,
                     (const ConeSide& side, const SlicePath& path, ColumnBlock& block),
                     (side, path, block))
KERF_FOR_BASE_TARGET(void, evaluate_arc,
                     (const ArcSide& side, const SlicePath& path, ColumnBlock& block),
                     (side, path, block))

}  // namespace kerf
