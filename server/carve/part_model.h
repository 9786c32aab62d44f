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
  /// `mesh`, in scene coordinates, must outlive this object and have a triangle; `grid` is that of
  /// the block along Z.
  PartModel(const IndexedMesh& mesh, const DexelGrid& grid);
  PartModel(const PartModel&) = delete;
  PartModel& operator=(const PartModel&) = delete;

  const MeshDistance& surface() const { return surface_; }
  /// Returns the material of the part inside the block's bounds; null if the mesh bounds no solid.
  const DexelSnapshot* material() const { return material_ ? &*material_ : nullptr; }
  /// Returns why the mesh bounds no solid, as a sentence; empty if it does.
  const std::string& fault() const { return fault_; }

 private:
  MeshDistance surface_;
  std::optional<DexelSnapshot> material_;
  std::string fault_;
};

/// Returns the bounds of a mesh in scene coordinates, to 1e-4 mm, because it is stored in floats.
BoxStock bounds_of(const IndexedMesh& mesh);

}  // namespace kerf
