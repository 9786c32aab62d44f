// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <expected>
#include <optional>
#include <span>
#include <stop_token>
#include <string>

#include "kernel/dexel/triangle_mesh.h"
#include "server/formats/model/mesh_placement.h"
#include "server/formats/model/repair_mesh.h"

namespace kerf {

/// A mesh as named in a scene.
struct MeshFile {
  std::string file;     ///< "" if there is none
  bool repair = false;  ///< close its holes and orient its triangles (repair_mesh)
  /// The unit of the file's numbers, mm. By default mm, or the unit stated by a 3MF or GLB file.
  std::optional<double> unit_mm;
  MeshPlacement placement;  ///< its unit_mm is not used
};

/// A mesh that has been read and placed.
struct LoadedMesh {
  TriangleMesh mesh;
  MeshRepair repair;
};
using LoadMeshResult = std::expected<LoadedMesh, std::string>;

/// Reads a file's mesh, places it, and repairs it on request. Errors, as one clause: an unknown
/// extension, a unit for a format that states its own, the reader's, repair_mesh's. Ends soon after
/// a stop is requested ("stopped").
LoadMeshResult load_mesh(const MeshFile& file, std::span<const std::byte> bytes,
                         const std::stop_token& stop = {});

/// load_mesh, for readers of scenes that are not linked with the model formats.
using LoadMesh = LoadMeshResult (*)(const MeshFile& file, std::span<const std::byte> bytes,
                                    const std::stop_token& stop);

}  // namespace kerf
