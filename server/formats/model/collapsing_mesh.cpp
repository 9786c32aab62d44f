// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/collapsing_mesh.h"

#include <algorithm>
#include <utility>

namespace kerf {

CollapsingMesh::CollapsingMesh(const IndexedMesh& mesh)
    : triangles_(mesh.triangles),
      first_corner_(mesh.positions_mm.size(), kNone),
      next_corner_(3 * mesh.triangles.size()),
      size_(mesh.triangles.size()) {
  positions_.reserve(mesh.positions_mm.size());
  for (std::uint32_t v = 0; v < mesh.positions_mm.size(); ++v)
    positions_.push_back(mesh.position(v));
  for (std::uint32_t corner = 0; corner < next_corner_.size(); ++corner) {
    std::uint32_t& first = first_corner_[triangles_[corner / 3][corner % 3]];
    if (first == kNone) next_corner_[corner] = first = corner;
    next_corner_[corner] = std::exchange(next_corner_[first], corner);
  }
}

std::vector<CollapsingMesh::Triangle> CollapsingMesh::remaining() const {
  std::vector<Triangle> left;
  left.reserve(size_);
  std::ranges::copy_if(triangles_, std::back_inserter(left),
                       [](const Triangle& t) { return t[0] != kNone; });
  return left;
}

void CollapsingMesh::collapse(std::uint32_t from, std::uint32_t to,
                              const std::vector<std::uint32_t>& around) {
  for (const std::uint32_t t : around) {
    Triangle& triangle = triangles_[t];
    if (std::ranges::find(triangle, to) != triangle.end()) {
      triangle.fill(kNone);
      --size_;
    } else {
      std::ranges::replace(triangle, from, to);
    }
  }
  std::swap(next_corner_[first_corner_[from]], next_corner_[first_corner_[to]]);
  drop_gone(to);
}

// Removes the corners of deleted triangles from the ring of a vertex.
void CollapsingMesh::drop_gone(std::uint32_t vertex) {
  std::uint32_t before = first_corner_[vertex];
  while (is_gone(before / 3)) before = next_corner_[before];
  first_corner_[vertex] = before;
  for (std::uint32_t corner = next_corner_[before]; corner != first_corner_[vertex];
       corner = next_corner_[corner]) {
    if (is_gone(corner / 3)) {
      next_corner_[before] = next_corner_[corner];
    } else {
      before = corner;
    }
  }
}

}  // namespace kerf
