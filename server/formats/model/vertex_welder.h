// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "server/formats/model/mesh_source.h"

namespace kerf {

/// Assigns common vertex numbers across the pieces of a surface: positions with equal bits are one
/// vertex, regardless of piece and normals. A vertex is forgotten when its fan of triangles is
/// closed, so that only the seams toward later pieces are in memory.
class VertexWelder {
 public:
  struct Welded {
    std::vector<std::uint32_t>
        fresh;  ///< indices of positions in the piece that are new vertices, in order
    std::vector<std::uint32_t> indices;  ///< of the whole model; three per triangle
  };
  /// The result is valid until the next call.
  const Welded& weld(const MeshPiece& piece);
  /// Returns the number of vertices so far. Indices have 32 bits: see overflowed().
  std::uint64_t vertices() const { return vertices_; }
  bool overflowed() const { return vertices_ > UINT32_MAX; }
  /// Returns the number of vertices in memory.
  std::size_t remembered() const { return open_.size(); }

 private:
  using Position = std::array<std::uint32_t, 3>;
  struct PositionHash {
    std::size_t operator()(const Position& p) const;
  };
  struct Vertex {
    std::uint32_t number;
    std::uint64_t fan;  ///< 0 if each neighbor came as often before it as after
  };
  std::unordered_map<Position, Vertex, PositionHash> open_;
  std::vector<Vertex*> vertex_of_;
  std::uint64_t vertices_ = 0;
  Welded welded_;
};

}  // namespace kerf
