// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "server/formats/model/mesh_source.h"

namespace kerf {

/// Gives the pieces of a surface common vertex numbers: positions of equal bits are one vertex,
/// whichever piece they stand in and however many normals they have there. A vertex is forgotten as
/// soon as its fan of triangles is closed, so only the seams towards pieces that are still to come
/// are in memory.
class VertexWelder {
 public:
  struct Welded {
    std::vector<std::uint32_t> fresh;    ///< positions of the piece that are new vertices, in order
    std::vector<std::uint32_t> indices;  ///< of the whole model; three per triangle
  };
  /// The result is valid until the next call.
  const Welded& weld(const MeshPiece& piece);
  /// So many vertices have been numbered, from 0 on. What lies beyond 32 bits cannot be counted:
  /// see overflowed().
  std::uint64_t vertices() const { return vertices_; }
  bool overflowed() const { return vertices_ > UINT32_MAX; }
  /// Vertices that are remembered at the moment.
  std::size_t remembered() const { return open_.size(); }

 private:
  using Position = std::array<std::uint32_t, 3>;
  struct PositionHash {
    std::size_t operator()(const Position& p) const;
  };
  struct Vertex {
    std::uint32_t number;
    std::uint64_t fan;  ///< 0 when each neighbour came as often before as behind it
  };
  std::unordered_map<Position, Vertex, PositionHash> open_;
  std::vector<Vertex*> vertex_of_;
  std::uint64_t vertices_ = 0;
  Welded welded_;
};

}  // namespace kerf
