// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <optional>
#include <string>

#include "server/carve/misfits.h"

namespace kerf {

/// A point of a part outside the stock.
struct Shortfall {
  double mm = 0;  ///< distance from the stock
  Vec3 at_mm;
};

/// How a carved block fits a part.
struct PartFit {
  std::optional<Misfits> gouges;       ///< empty without a part
  std::optional<Misfits> rests;        ///< searched only if requested
  std::optional<Shortfall> shortfall;  ///< the greatest, if beyond the tolerance
  double loose_mm3 = 0;                ///< of pieces that were cut loose (attached_material.h)
};

/// Scope and tolerance of the search.
struct PartFitRequest {
  double tolerance_mm;  ///< of the part
  bool two_sided;       ///< search for rests and the shortfall too; the mesh must bound a solid
};

/// Compares a block before and after a program with a part, a mesh in scene coordinates. The error,
/// one clause, says why the mesh bounds no solid. Ends early if a stop is requested. The result
/// must then not be used.
std::expected<PartFit, std::string> fit_part(const DexelSnapshot& before,
                                             const DexelSnapshot& after, const IndexedMesh& mesh,
                                             const Scene& scene, const Program& program,
                                             const PartFitRequest& request,
                                             const SearchControl& control);

}  // namespace kerf
