// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "server/formats/model/indexed_mesh.h"
#include "server/formats/model/mesh_distance.h"

namespace kerf::net {

/// The properties of a target part, without its triangles.
struct TargetFacts {
  std::string name;  ///< the file name, which identifies it
  std::string tag;   ///< equal for the same file and placement, else different
  std::size_t triangles = 0;
  Vec3 min_mm, max_mm;  ///< bounds in scene coordinates
  Vec3 shift_mm;        ///< added to the file's coordinates, after scaling
  double unit_mm = 1;   ///< mm per unit of the file
  std::string author;   ///< grant that stored it; empty if none
  std::string fault;    ///< why the mesh bounds no solid; empty if it does
};

/// A part with which blocks are compared. Immutable.
class TargetPart {
 public:
  TargetPart(TargetFacts facts, IndexedMesh mesh)
      : facts_(std::move(facts)), mesh_(std::move(mesh)), distance_(mesh_) {}
  TargetPart(const TargetPart&) = delete;
  TargetPart& operator=(const TargetPart&) = delete;

  const TargetFacts& facts() const { return facts_; }
  const IndexedMesh& mesh() const { return mesh_; }
  const MeshDistance& distance() const { return distance_; }

 private:
  TargetFacts facts_;
  IndexedMesh mesh_;
  MeshDistance distance_;
};

/// Converts the properties of a part to the text of its file, and back; nullopt if the text is
/// damaged.
std::string facts_text(const TargetFacts& facts);
std::optional<TargetFacts> parse_facts(const std::string& text);

}  // namespace kerf::net
