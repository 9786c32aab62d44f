// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/turning_rows.h"

namespace kerf {
namespace {

[[maybe_unused]] KERF_INLINE void evaluate_cone_in_lanes(const ConeSide& side,
                                                         const SlicePath& path,
                                                         const RowBits& known, ColumnBlock& block) {
  evaluate_rows(side, path, known, block);
}
[[maybe_unused]] KERF_INLINE void add_simple_cone_rows_in_lanes(const ConeSide& side,
                                                                const SlicePath& path,
                                                                const RowBits& known,
                                                                ColumnBlock& block) {
  add_simple_rows(side, path, known, block);
}
[[maybe_unused]] KERF_INLINE void search_packed_cone_in_lanes(const ConeSide& side,
                                                              const SlicePath& path,
                                                              PackedRays& rays, bool finish,
                                                              ColumnBlock& block) {
  search_packed(side, path, rays, finish, block);
}
[[maybe_unused]] KERF_INLINE void evaluate_arc_in_lanes(const ArcSide& side, const SlicePath& path,
                                                        const RowBits& known, ColumnBlock& block) {
  evaluate_rows(side, path, known, block);
}
[[maybe_unused]] KERF_INLINE void add_simple_arc_rows_in_lanes(const ArcSide& side,
                                                               const SlicePath& path,
                                                               const RowBits& known,
                                                               ColumnBlock& block) {
  add_simple_rows(side, path, known, block);
}
[[maybe_unused]] KERF_INLINE void search_packed_arc_in_lanes(const ArcSide& side,
                                                             const SlicePath& path,
                                                             PackedRays& rays, bool finish,
                                                             ColumnBlock& block) {
  search_packed(side, path, rays, finish, block);
}

}  // namespace

KERF_FOR_VECTOR_TARGETS(void, evaluate_cone,
                        (const ConeSide& side, const SlicePath& path, const RowBits& known,
                         ColumnBlock& block),
                        (side, path, known, block))
KERF_FOR_VECTOR_TARGETS(void, add_simple_cone_rows,
                        (const ConeSide& side, const SlicePath& path, const RowBits& known,
                         ColumnBlock& block),
                        (side, path, known, block))
KERF_FOR_VECTOR_TARGETS(void, search_packed_cone,
                        (const ConeSide& side, const SlicePath& path, PackedRays& rays, bool finish,
                         ColumnBlock& block),
                        (side, path, rays, finish, block))
KERF_FOR_VECTOR_TARGETS(void, evaluate_arc,
                        (const ArcSide& side, const SlicePath& path, const RowBits& known,
                         ColumnBlock& block),
                        (side, path, known, block))
KERF_FOR_VECTOR_TARGETS(void, add_simple_arc_rows,
                        (const ArcSide& side, const SlicePath& path, const RowBits& known,
                         ColumnBlock& block),
                        (side, path, known, block))
KERF_FOR_VECTOR_TARGETS(void, search_packed_arc,
                        (const ArcSide& side, const SlicePath& path, PackedRays& rays, bool finish,
                         ColumnBlock& block),
                        (side, path, rays, finish, block))

}  // namespace kerf
