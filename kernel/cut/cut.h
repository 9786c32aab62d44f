// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/cut/removal.h"
#include "kernel/cut/workers.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/sweep/swept_tool.h"

namespace kerf {

/// Removes a swept tool from the field and stores in `removal` what was removed; its previous
/// contents are dropped. Performs the three updates of paper Fig. 1 (c–e): shortening an element at
/// its top or its bottom, or splitting it. Ends are rounded to the nearest depth quantum before
/// they are compared, so cuts commute to the bit. Columns that do not change are not written. Large
/// cuts are divided among `workers` by tiles. In a field that keeps normals, the ends that move are
/// marked with `end_code` (lazy_normals.h).
void cut(DexelField& field, const SweptTool& swept, Removal& removal, Workers& workers,
         NormalCode end_code = kStockNormal);

}  // namespace kerf
