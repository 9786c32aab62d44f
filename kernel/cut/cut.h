// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/cut/removal.h"
#include "kernel/cut/workers.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/sweep/swept_tool.h"

namespace kerf {

/// Removes a swept tool from the field and fills `removal` with what was taken (its former content
/// is dropped). The three updates of paper Fig. 1 (c–e): the top of an element is shortened, its
/// bottom is shortened, or it is split. Ends are rounded to the nearest depth quantum before they
/// are compared, so that any order of the same cuts leaves the same bytes. Columns that do not
/// change are not written. Where there is much to do its tiles are divided among `workers`. In a
/// field that keeps normals the ends that move get the code `end_code` (lazy_normals.h).
void cut(DexelField& field, const SweptTool& swept, Removal& removal, Workers& workers,
         NormalCode end_code = kStockNormal);

}  // namespace kerf
