// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <optional>

#include "server/formats/model/indexed_mesh.h"
#include "server/formats/model/model_writer.h"

namespace kerf {

/// How much smaller a model may be made; at least one of the two.
struct SimplifyRequest {
  std::optional<std::uint64_t> triangles;  ///< at most so many, > 0
  std::optional<double> error_mm;          ///< nowhere farther from the exact surface, > 0
};

struct SimplifiedMesh {
  IndexedMesh mesh;
  std::uint64_t original_triangles = 0;
  /// Greatest distance of a vertex of the exact surface from the simplified one, or of a corner,
  /// edge middle or centroid of that one from the exact surface: measured, not estimated.
  double error_mm = 0;
};

/// The surface with fewer triangles, by collapsing edges where that does least harm (meshoptimizer,
/// after Garland, Heckbert, Surface simplification using quadric error metrics, 1997). It stays
/// closed and 2-manifold: where a collapse makes more than two triangles share an edge, the surface
/// around it is kept as it was. Needs about 200 bytes for each triangle of the source. An error
/// where the budget cannot be kept, with what could be had.
std::expected<SimplifiedMesh, ModelError> simplify_mesh(MeshSource& source,
                                                        const SimplifyRequest& request,
                                                        const ModelProgress& progress = {});

}  // namespace kerf
