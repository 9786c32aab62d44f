// SPDX-License-Identifier: Apache-2.0
#include "server/formats/mesh_file.h"

#include "server/formats/model/mesh_reader.h"

namespace kerf {

LoadMeshResult load_mesh(const MeshFile& file, std::span<const std::byte> bytes,
                         const std::stop_token& stop) {
  const auto format = mesh_file_format(file.file);
  if (!format) return std::unexpected(std::string("must be a ") + kMeshFileNames + " file");
  const bool has_unit = format == MeshFileFormat::k3mf || format == MeshFileFormat::kGlb;
  if (file.unit_mm && has_unit)
    return std::unexpected("states the unit of its numbers itself: leave the unit out");
  auto mesh = read_mesh(*format, bytes, kMeshTrianglesMax, stop);
  if (!mesh) return std::unexpected(mesh.error().reason);
  LoadedMesh loaded{*std::move(mesh), {}};
  MeshPlacement placement = file.placement;
  placement.unit_mm = file.unit_mm.value_or(1);
  place_mesh(loaded.mesh, placement);
  if (file.repair) {
    const auto repair = repair_mesh(loaded.mesh, stop);
    if (!repair) return std::unexpected("cannot be repaired: " + repair.error());
    loaded.repair = *repair;
  }
  return loaded;
}

}  // namespace kerf
