// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <stop_token>

#include "server/formats/model/indexed_mesh.h"
#include "server/formats/model/model_writer.h"

namespace kerf {

/// Limits of a simplification. At least one must be set.
struct SimplifyRequest {
  std::optional<std::uint64_t> triangles;  ///< maximum number of triangles, > 0
  std::optional<double> error_mm;          ///< maximum distance from the exact surface, mm, > 0
};

struct SimplifiedMesh {
  IndexedMesh mesh;
  std::uint64_t original_triangles = 0;
  /// Greatest measured distance of a vertex of the exact surface from the simplified one, or of a
  /// corner, edge midpoint or centroid of the simplified surface from the exact one.
  double error_mm = 0;
  /// Triangles that meet others outside common corners and edges, or have no area. Not 0 only if
  /// the requested number of triangles is too small for a result without.
  std::size_t crossing_triangles = 0;
};

/// Reduces the number of triangles by collapsing edges (edge_collapse.h). The result is closed and
/// 2-manifold, and its error is measured. Where it exceeds the bound, or triangles cross
/// (mesh_crossings.h), the surrounding surface is kept and collapsing is repeated. With a number of
/// triangles only, smaller errors are tried as long as it is reached. If it is too small for a
/// result without crossings, the one with fewest is returned. Needs the whole surface in memory,
/// about 300 bytes per triangle. Errors: limits that cannot be met, with the smallest number of
/// triangles reached; a requested stop, which ends each of the steps.
std::expected<SimplifiedMesh, ModelError> simplify_mesh(MeshSource& source,
                                                        const SimplifyRequest& request,
                                                        const ModelProgress& progress = {},
                                                        const std::stop_token& stop = {});

}  // namespace kerf
