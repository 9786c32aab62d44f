// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/sweep/turning_rows.h"

// Defines the functions that turning_rows.h declares, for one instruction set: the unit that
// includes this file defines KERF_UNIT_TARGET, its attribute, and KERF_FOR_UNIT_TARGET, the macro
// of kernel/math/targets.h for it.

#define KERF_OUT_OF_LINE KERF_UNIT_TARGET __attribute__((noinline))

namespace kerf {
namespace {

/// A side for which the long functions are called, not inlined: the copies of a row's and a batch's
/// loops would not fit into the instruction cache of a core, and take minutes to compile.
template <class Side>
struct OutOfLine {
  const Side& side;

  KERF_INLINE LaneMask holds(Lanes rho2, Lanes l) const { return side.holds(rho2, l); }
};

template <class Side>
KERF_OUT_OF_LINE Meeting at_upper_end(const OutOfLine<Side>& outer, const SlicePath& path,
                                      const Lanes& x, const Lanes& y, double share,
                                      const Meeting& m) {
  return kerf::at_upper_end(outer.side, path, x, y, share, m);
}

template <End end, class Side>
KERF_OUT_OF_LINE Meeting meet_at(const OutOfLine<Side>& outer, const SlicePath& path,
                                 const Lanes& x, const Lanes& y, const TurningFrame::Poses& pose) {
  return kerf::meet_at<end>(outer.side, path, x, y, pose);
}

template <End end, class Side>
KERF_OUT_OF_LINE Crossing cross_piece(const OutOfLine<Side>& outer, const TurningFrame::Poses& pose,
                                      const Lanes& x, const Lanes& y, double top_mm) {
  return kerf::cross_piece<end>(outer.side, pose, x, y, top_mm);
}

template <class Side>
KERF_OUT_OF_LINE Lanes depth_at(const OutOfLine<Side>& outer, const SlicePath& path,
                                const RayRow& row, const Lanes& share, const Meeting& m) {
  return kerf::depth_at(outer.side, path, row, share, m);
}

template <class Side>
KERF_OUT_OF_LINE Lanes reach_beside(const OutOfLine<Side>& outer, const SlicePath& path,
                                    const Lanes& x, const Lanes& y, const FoundEnd& e, double sign,
                                    const Lanes& length, double depth_mm) {
  return kerf::reach_beside(outer.side, path, x, y, e, sign, length, depth_mm);
}

template <End end, class Side>
KERF_OUT_OF_LINE Lanes reach_of(const OutOfLine<Side>& outer, const SlicePath& path, const Lanes& x,
                                const Lanes& y, const FoundEnd& e, double sign, const Lanes& best,
                                const Lanes& length, double depth_mm, bool beside) {
  return kerf::reach_of<end>(outer.side, path, x, y, e, sign, best, length, depth_mm, beside);
}

template <class Side>
KERF_INLINE void search_rays(const OutOfLine<Side>& outer, const SlicePath& path, PackedRays& rays,
                             bool finish, ColumnBlock& block) {
  kerf::search_rays(outer.side, path, rays, finish, block);
}

[[maybe_unused]] KERF_INLINE void evaluate_cone_in_lanes(const ConeSide& side,
                                                         const SlicePath& path,
                                                         const RowBits& known, ColumnBlock& block) {
  evaluate_rows(OutOfLine<ConeSide>{side}, path, known, block);
}
[[maybe_unused]] KERF_INLINE void add_simple_cone_rows_in_lanes(const ConeSide& side,
                                                                const SlicePath& path,
                                                                const RowBits& known,
                                                                ColumnBlock& block) {
  add_simple_rows(OutOfLine<ConeSide>{side}, path, known, block);
}
[[maybe_unused]] KERF_INLINE void search_packed_cone_in_lanes(const ConeSide& side,
                                                              const SlicePath& path,
                                                              PackedRays& rays, bool finish,
                                                              ColumnBlock& block) {
  search_packed(OutOfLine<ConeSide>{side}, path, rays, finish, block);
}
[[maybe_unused]] KERF_INLINE void evaluate_arc_in_lanes(const ArcSide& side, const SlicePath& path,
                                                        const RowBits& known, ColumnBlock& block) {
  evaluate_rows(OutOfLine<ArcSide>{side}, path, known, block);
}
[[maybe_unused]] KERF_INLINE void add_simple_arc_rows_in_lanes(const ArcSide& side,
                                                               const SlicePath& path,
                                                               const RowBits& known,
                                                               ColumnBlock& block) {
  add_simple_rows(OutOfLine<ArcSide>{side}, path, known, block);
}
[[maybe_unused]] KERF_INLINE void search_packed_arc_in_lanes(const ArcSide& side,
                                                             const SlicePath& path,
                                                             PackedRays& rays, bool finish,
                                                             ColumnBlock& block) {
  search_packed(OutOfLine<ArcSide>{side}, path, rays, finish, block);
}

}  // namespace

KERF_FOR_UNIT_TARGET(void, evaluate_cone,
                     (const ConeSide& side, const SlicePath& path, const RowBits& known,
                      ColumnBlock& block),
                     (side, path, known, block))
KERF_FOR_UNIT_TARGET(void, add_simple_cone_rows,
                     (const ConeSide& side, const SlicePath& path, const RowBits& known,
                      ColumnBlock& block),
                     (side, path, known, block))
KERF_FOR_UNIT_TARGET(void, search_packed_cone,
                     (const ConeSide& side, const SlicePath& path, PackedRays& rays, bool finish,
                      ColumnBlock& block),
                     (side, path, rays, finish, block))
KERF_FOR_UNIT_TARGET(void, evaluate_arc,
                     (const ArcSide& side, const SlicePath& path, const RowBits& known,
                      ColumnBlock& block),
                     (side, path, known, block))
KERF_FOR_UNIT_TARGET(void, add_simple_arc_rows,
                     (const ArcSide& side, const SlicePath& path, const RowBits& known,
                      ColumnBlock& block),
                     (side, path, known, block))
KERF_FOR_UNIT_TARGET(void, search_packed_arc,
                     (const ArcSide& side, const SlicePath& path, PackedRays& rays, bool finish,
                      ColumnBlock& block),
                     (side, path, rays, finish, block))

}  // namespace kerf
