// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "kernel/dexel/dexel_snapshot.h"
#include "server/formats/model/mesh_distance.h"

namespace kerf {

/// A part that blocks are compared with: its surface, and its material on the rays of a block.
class PartModel {
 public:
  /// `surface` is that of `mesh`, in scene coordinates, and must outlive this object. `grid` is
  /// that of the block along Z.
  PartModel(const IndexedMesh& mesh, const MeshDistance& surface, const DexelGrid& grid);
  PartModel(const PartModel&) = delete;
  PartModel& operator=(const PartModel&) = delete;

  const MeshDistance& surface() const { return surface_; }
  /// Returns the grid of the block.
  const DexelGrid& grid() const { return grid_; }
  /// Returns the material of the part inside the block's bounds, or null if the mesh bounds no
  /// solid.
  const DexelSnapshot* material() const { return material_ ? &*material_ : nullptr; }
  /// Returns why the mesh bounds no solid, as a sentence, or empty if it does.
  const std::string& fault() const { return fault_; }

 private:
  const MeshDistance& surface_;
  DexelGrid grid_;
  std::optional<DexelSnapshot> material_;
  std::string fault_;
};

/// Returns the bounds of a mesh in scene coordinates, to 1e-4 mm, because it is stored in floats.
BoxStock bounds_of(const IndexedMesh& mesh);

}  // namespace kerf
