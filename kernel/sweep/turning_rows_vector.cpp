// SPDX-License-Identifier: Apache-2.0
#include "kernel/sweep/turning_rows.h"

namespace kerf {
namespace {

[[maybe_unused]] KERF_INLINE void evaluate_cone_in_lanes(const ConeSide& side,
                                                         const SlicePath& path,
                                                         ColumnBlock& block) {
  evaluate_rows(side, path, block);
}
[[maybe_unused]] KERF_INLINE void evaluate_arc_in_lanes(const ArcSide& side, const SlicePath& path,
                                                        ColumnBlock& block) {
  evaluate_rows(side, path, block);
}

}  // namespace

KERF_FOR_VECTOR_TARGETS(void, evaluate_cone,
                        (const ConeSide& side, const SlicePath& path, ColumnBlock& block),
                        (side, path, block))
KERF_FOR_VECTOR_TARGETS(void, evaluate_arc,
                        (const ArcSide& side, const SlicePath& path, ColumnBlock& block),
                        (side, path, block))

}  // namespace kerf
