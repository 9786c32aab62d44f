// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "kernel/cut/removal.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/sweep/swept_surface.h"

namespace kerf {

/// How the stock looks at the ends that sweeps have made, computed when somebody is about to look.
/// A hand cuts the same column dozens of times before it moves on, and only the last end stays: so
/// an end first gets the number of the sweep that made it in place of its normal, and a debt is
/// paid once for all ends that are still there. What an end gets does not depend on when. Ends that
/// a sweep did not move keep the normals that they have; an end that two motions leave at the same
/// depth has the normal of the one that came first, so normals follow the order of the commands,
/// and the state's hash does not look at them.
class OwedNormals {
 public:
  /// Takes note of a sweep that is about to cut the field, by its surface in the field's frame, and
  /// returns the code for the ends that it makes (note_ends). A debt of kSweepsMax sweeps is paid
  /// first.
  NormalCode owe(DexelField& field, const SweptSurface& surface);
  /// The tiles that the sweep has changed.
  void note(const Removal& removal);
  /// Gives every end its normal. To be called before the field is looked at.
  void pay(DexelField& field);

 private:
  /// Few enough that paying is no pause for a hand, many enough that most ends are gone by then.
  static constexpr std::size_t kSweepsMax = 256;
  struct End {
    NormalCode* code;
    double x_mm, y_mm, z_mm;
  };
  /// The ends that one sweep has left.
  struct Ends {
    std::vector<End> tops, bottoms;
  };

  void collect(DexelTile& tile, TileIndex at, const DexelGrid& grid);

  std::vector<SweptSurface> sweeps_;
  std::vector<TileIndex> tiles_;
  std::vector<Ends> ends_;  ///< of each sweep; kept for its memory
};

/// Marks in a tile that keeps normals the ends that a sweep has just made: `removed` is what it
/// took of this tile.
void note_ends(DexelTile& tile, std::span<const RemovedGroup> removed, NormalCode code);

}  // namespace kerf
