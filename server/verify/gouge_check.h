// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/verify/changed_rows.h"
#include "server/verify/column_misfits.h"

namespace kerf {

/// A part that a program must not cut below. Immutable after the start.
struct GougeReference {
  std::string name;
  std::shared_ptr<const PartModel> part;
  double tolerance_mm = 0;  ///< > 0
};

/// The deepest cut of a motion below a part.
struct Gouge {
  double depth_mm = 0;  ///< distance from the surface of the part, > the tolerance
  Vec3 at_mm;
};

/// Finds how deep a motion has cut below a part, in the columns along Z that it has changed. The
/// work is done in portions, because a column deep inside a part takes a millisecond.
class GougeCheck {
 public:
  /// `reference` must outlive this object. `cut` are the tiles that lost material (repeats
  /// allowed).
  GougeCheck(const GougeReference& reference, DexelSnapshot before, DexelSnapshot after,
             const std::vector<FieldTile>& cut);

  /// Continues until about so many distances from the part have been computed. Returns true when
  /// everything is measured. A tile without deep cuts also costs some.
  bool advance(std::size_t distances);
  /// Returns the deepest point, if the motion has cut deeper than the tolerance.
  const std::optional<Gouge>& deepest() const { return deepest_; }

 private:
  void measure(std::int32_t i, std::int32_t j);

  ChangedRows rows_;
  ColumnMisfits columns_;
  std::optional<Gouge> deepest_;
};

}  // namespace kerf
