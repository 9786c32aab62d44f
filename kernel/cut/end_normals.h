#pragma once

#include <span>

#include "kernel/cut/removal.h"
#include "kernel/dexel/dexel_grid.h"
#include "kernel/dexel/dexel_tile.h"
#include "kernel/sweep/swept_surface.h"

namespace kerf {

/// Notes in a tile that keeps normals how the stock now looks at the ends that a sweep has just
/// made: `removed` is what it took of this tile, `surface` the swept surface in the field's frame.
/// Ends that the sweep did not move keep the normals that they have. An end that two motions leave
/// at the same depth has the normal of the one that came first, so normals follow the order of the
/// commands, and the state's hash does not look at them.
void note_normals(DexelTile& tile, const DexelGrid& grid, std::span<const RemovedGroup> removed,
                  const SweptSurface& surface);

}  // namespace kerf
