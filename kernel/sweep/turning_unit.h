// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/sweep/turning_rows.h"

// Defines the functions that turning_rows.h declares, for one instruction set. The unit that
// includes this file defines KERF_UNIT_TARGET, its attribute, and KERF_FOR_UNIT_TARGET, the macro
// of kernel/math/targets.h for it.

#define KERF_OUT_OF_LINE KERF_UNIT_TARGET __attribute__((noinline))

namespace kerf {
namespace {

/// A side of either kind, for which the long functions are called instead of inlined. Copies of a
/// row's and a batch's loops would not fit into the instruction cache of a core, and take minutes
/// to compile.
struct OutOfLine {
  const PieceSide& side;
  const ConeSide* cone = std::get_if<ConeSide>(&side);
  const ArcSide* arc = std::get_if<ArcSide>(&side);  ///< null for a cone
  double anchor = cone ? cone->anchor : arc->anchor;
  double low = cone ? cone->low : arc->low, high = cone ? cone->high : arc->high;
  double widest = cone ? cone->widest : arc->widest;

  KERF_INLINE LaneMask holds(Lanes rho2, Lanes l) const {
    if (cone) return cone->holds(rho2, l);
    return arc->holds(rho2, l);
  }
  KERF_INLINE Vec3Lanes normal(const Vec3Lanes& p, Lanes l, const Vec3Lanes& u) const {
    if (cone) return cone->normal(p, l, u);
    return arc->normal(p, l, u);
  }
  KERF_INLINE Lanes clearance(const Vec3Lanes& p, Lanes l, const Vec3Lanes& u) const {
    if (cone) return cone->clearance(p, l, u);
    return arc->clearance(p, l, u);
  }
  KERF_INLINE SideTilt tilt(const Vec3Lanes& p, Lanes l, const Vec3Lanes& u, const Vec3Lanes& n,
                            Lanes off) const {
    if (cone) return cone->tilt(p, l, u, n, off);
    return arc->tilt(p, l, u, n, off);
  }
};

template <End end>
KERF_OUT_OF_LINE Meeting meet_at(const OutOfLine& outer, const SlicePath& path, const Lanes& x,
                                 const Lanes& y, const TurningFrame::Poses& pose) {
  if (outer.cone) return kerf::meet_at<end>(*outer.cone, path, x, y, pose);
  return kerf::meet_at<end>(*outer.arc, path, x, y, pose);
}

template <End end>
KERF_OUT_OF_LINE Crossing cross_piece(const OutOfLine& outer, const TurningFrame::Poses& pose,
                                      const Lanes& x, const Lanes& y, double top_mm) {
  if (outer.cone) return kerf::cross_piece<end>(*outer.cone, pose, x, y, top_mm);
  return kerf::cross_piece<end>(*outer.arc, pose, x, y, top_mm);
}

KERF_OUT_OF_LINE Meeting at_upper_end(const OutOfLine& outer, const SlicePath& path, const Lanes& x,
                                      const Lanes& y, double share, const Meeting& m) {
  return kerf::at_upper_end<OutOfLine>(outer, path, x, y, share, m);
}

KERF_OUT_OF_LINE Lanes depth_at(const OutOfLine& outer, const SlicePath& path, const RayRow& row,
                                const Lanes& share, const Meeting& m) {
  return kerf::depth_at<OutOfLine>(outer, path, row, share, m);
}

KERF_OUT_OF_LINE Lanes reach_beside(const OutOfLine& outer, const SlicePath& path, const Lanes& x,
                                    const Lanes& y, const FoundEnd& e, double sign,
                                    const Lanes& length, double depth_mm) {
  return kerf::reach_beside<OutOfLine>(outer, path, x, y, e, sign, length, depth_mm);
}

template <End end>
KERF_OUT_OF_LINE Lanes reach_of(const OutOfLine& outer, const SlicePath& path, const Lanes& x,
                                const Lanes& y, const FoundEnd& e, double sign, const Lanes& best,
                                const Lanes& length, double depth_mm, bool beside) {
  return kerf::reach_of<end, OutOfLine>(outer, path, x, y, e, sign, best, length, depth_mm, beside);
}

KERF_INLINE void search_rays(const OutOfLine& outer, const SlicePath& path, PackedRays& rays,
                             bool finish, ColumnBlock& block) {
  search_packed_rays(outer.side, path, rays, finish, block);
}

[[maybe_unused]] KERF_INLINE void evaluate_slice_in_lanes(const PieceSide& side,
                                                          const SlicePath& path,
                                                          const RowBits& known,
                                                          ColumnBlock& block) {
  evaluate_rows(OutOfLine{side}, path, known, block);
}
[[maybe_unused]] KERF_INLINE void add_simple_rows_of_slice_in_lanes(const PieceSide& side,
                                                                    const SlicePath& path,
                                                                    const RowBits& known,
                                                                    ColumnBlock& block) {
  add_simple_rows(OutOfLine{side}, path, known, block);
}
[[maybe_unused]] KERF_INLINE void search_packed_rays_in_lanes(const PieceSide& side,
                                                              const SlicePath& path,
                                                              PackedRays& rays, bool finish,
                                                              ColumnBlock& block) {
  search_packed(OutOfLine{side}, path, rays, finish, block);
}

}  // namespace

KERF_FOR_UNIT_TARGET(void, evaluate_slice,
                     (const PieceSide& side, const SlicePath& path, const RowBits& known,
                      ColumnBlock& block),
                     (side, path, known, block))
KERF_FOR_UNIT_TARGET(void, add_simple_rows_of_slice,
                     (const PieceSide& side, const SlicePath& path, const RowBits& known,
                      ColumnBlock& block),
                     (side, path, known, block))
KERF_FOR_UNIT_TARGET(void, search_packed_rays,
                     (const PieceSide& side, const SlicePath& path, PackedRays& rays, bool finish,
                      ColumnBlock& block),
                     (side, path, rays, finish, block))

}  // namespace kerf
