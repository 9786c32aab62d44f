// SPDX-License-Identifier: Apache-2.0
#include "server/feed/step_join.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "server/feed/float3.h"

namespace kerf {
namespace {

/// Two vertices in a column of cells are on one surface if the cosine of the angle between their
/// normals is at least kAlike, and if it is not so steep that it may be a wall.
constexpr float kAlike = 0.97F;
constexpr float kSteep = 0.4F;

constexpr std::uint32_t kNoOther = ~std::uint32_t{0};

/// Chooses the vertices of a tile to drop, and their replacements.
class StepJoin {
 public:
  StepJoin(const TileMesh& mesh, std::span<const TileCell> cells, double pitch_mm, float error_mm)
      : mesh_(mesh),
        cells_(cells),
        per_pitch_(1 / static_cast<float>(pitch_mm)),
        to_(mesh.positions_mm.size()) {
    std::iota(to_.begin(), to_.end(), 0U);
    keep_repeated();
    each_edge([&](std::uint32_t a, std::uint32_t b) {
      const Float3 off = minus(mesh.positions_mm[b], mesh.positions_mm[a]);
      for (const std::uint32_t v : {a, b}) {
        // Neighbors of a dropped vertex are in its plane, and so is its replacement.
        if (std::abs(dot(mesh.normals[v], off)) > error_mm) stays_[v] = true;
      }
    });
    each_edge([&](std::uint32_t a, std::uint32_t b) { join(a, b); });
  }

  /// The remaining triangles.
  std::vector<std::uint32_t> indices() const {
    std::vector<std::uint32_t> left;
    left.reserve(mesh_.indices.size());
    for (std::size_t t = 0; t < mesh_.indices.size(); t += 3) {
      const std::array<std::uint32_t, 3> corner{
          joined(mesh_.indices[t]), joined(mesh_.indices[t + 1]), joined(mesh_.indices[t + 2])};
      if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) continue;
      left.insert(left.end(), corner.begin(), corner.end());
    }
    return left;
  }

 private:
  void each_edge(const auto& take) const {
    for (std::size_t t = 0; t < mesh_.indices.size(); t += 3) {
      for (std::size_t c = 0; c < 3; ++c) {
        take(mesh_.indices[t + c], mesh_.indices[t + (c + 1) % 3]);
      }
    }
  }

  std::uint32_t joined(std::uint32_t vertex) const {
    while (to_[vertex] != vertex) vertex = to_[vertex];
    return vertex;
  }

  /// Joins the two vertices of an edge into the one nearer to the middle of their cell.
  void join(std::uint32_t a, std::uint32_t b) {
    const TileCell at = cells_[a];
    const auto inside = [](int along) { return along > 0 && along < kTileSide; };
    if (at != cells_[b] || !inside(at.x) || !inside(at.y)) return;
    a = joined(a);
    b = joined(b);
    if (a == b || !is_one_surface(a, b)) return;
    if (!stays_[b] && (stays_[a] || off_middle(a) < off_middle(b))) std::swap(a, b);
    if (stays_[a]) return;
    to_[a] = b;
    stays_[b] = true;  // otherwise the first of a chain would be far from the last
  }

  /// A repeated position belongs to another surface beyond a crease, so it stays.
  void keep_repeated() {
    stays_.resize(to_.size());
    std::array<std::uint32_t, std::size_t{kCellsOfTile} * kCellsOfTile> newest;
    newest.fill(kNoOther);
    std::vector<std::uint32_t> before(to_.size());  // in the same column of cells
    for (std::uint32_t v = 0; v < to_.size(); ++v) {
      if (cells_[v] == TileCell{}) continue;
      std::uint32_t& last =
          newest[static_cast<std::size_t>(cells_[v].y * kCellsOfTile + cells_[v].x)];
      for (std::uint32_t other = last; other != kNoOther; other = before[other]) {
        if (mesh_.positions_mm[other] != mesh_.positions_mm[v]) continue;
        stays_[other] = stays_[v] = true;
      }
      before[v] = std::exchange(last, v);
    }
  }

  bool is_one_surface(std::uint32_t a, std::uint32_t b) const {
    const auto &na = mesh_.normals[a], &nb = mesh_.normals[b];
    return std::min(std::abs(na[2]), std::abs(nb[2])) >= kSteep && dot(na, nb) >= kAlike;
  }

  float off_middle(std::uint32_t vertex) const {
    float sum = 0;
    for (std::size_t c = 0; c < 2; ++c) {
      // The middle of a cell is at a multiple of the pitch.
      const float at = mesh_.positions_mm[vertex][c] * per_pitch_;
      sum += std::abs(at - std::round(at));
    }
    return sum;
  }

  const TileMesh& mesh_;
  std::span<const TileCell> cells_;
  float per_pitch_;
  std::vector<bool> stays_;        ///< by vertex
  std::vector<std::uint32_t> to_;  ///< by vertex: itself, or the one that replaces it
};

}  // namespace

std::vector<std::uint32_t> joined_steps(const TileMesh& mesh, std::span<const TileCell> cells,
                                        double pitch_mm, float error_mm) {
  return StepJoin(mesh, cells, pitch_mm, error_mm).indices();
}

}  // namespace kerf
