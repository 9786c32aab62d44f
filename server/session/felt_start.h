// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernel/dexel/solid_snapshot.h"
#include "server/history/stroke_table.h"

namespace kerf {

/// The block from which a carving with forces begins: after a record, without the strokes that are
/// undone at the end of the journal.
struct FeltStart {
  std::uint64_t last = 0;  ///< record
  StrokeSet undone = {};
  SolidSnapshot solid = {};
};

}  // namespace kerf
