// SPDX-License-Identifier: Apache-2.0
#include "server/feed/tile_border.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "server/feed/float3.h"
#include "server/feed/tile_cells.h"

namespace kerf {
namespace {

using Position = Float3;
constexpr std::uint32_t kNone = ~std::uint32_t{0};

/// An edge without an opposite one within the tile, between two places.
struct OpenEdge {
  std::uint32_t from = 0, to = 0;
  int count = 0;  ///< multiplicity; 1 unless the surface touches itself there
  friend auto operator<=>(const OpenEdge&, const OpenEdge&) = default;
};

/// The part of a tile's mesh in the cells that it shares with its neighbors: places (groups of
/// vertices with equal position), and the open edges between them.
class Border {
 public:
  Border(const TileMesh& mesh, const DexelGrid& grid) : place_(mesh.positions_mm.size(), kNone) {
    const std::array<std::int32_t, 2> tile{mesh.tile.x, mesh.tile.y};
    const std::array<std::int32_t, 2> columns{grid.columns_x, grid.columns_y};
    std::vector<Vertex> vertices;
    for (std::uint32_t v = 0; v < place_.size(); ++v) {
      Vertex vertex{mesh.positions_mm[v], v, 0};
      for (std::size_t axis = 0; axis < 2; ++axis) {
        const std::int32_t first = tile[axis] * kTileSide;
        const std::int32_t end = std::min(first + kTileSide, columns[axis]);
        const std::int32_t cell = cell_of(vertex.position[axis], grid.pitch_mm);
        if (cell == first - 1 && first > 0) vertex.sides |= 1U << (2 * axis);
        if (cell == end - 1 && end < columns[axis]) vertex.sides |= 2U << (2 * axis);
      }
      if (vertex.sides != 0) vertices.push_back(vertex);
    }
    weld(vertices);
  }

  std::size_t places() const { return positions_.size(); }
  const Position& position(std::uint32_t place) const { return positions_[place]; }
  /// The vertices of a place: the mesh has one for each normal there.
  std::span<const std::uint32_t> vertices(std::uint32_t place) const {
    return std::span(vertices_).subspan(first_[place], first_[place + 1] - first_[place]);
  }
  std::uint32_t place(std::uint32_t vertex) const { return place_[vertex]; }
  /// Bit n: the place is in the cells shared with neighbor n. Two bits in a corner of the tile.
  std::uint8_t sides(std::uint32_t place) const { return sides_[place]; }

  /// Returns the open edges of triangles that have the mesh's vertices as corners.
  std::vector<OpenEdge> open_edges(std::span<const std::uint32_t> indices) const {
    std::vector<Step> steps;
    for (std::size_t t = 0; t < indices.size(); t += 3) {
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t a = place_[indices[t + c]];
        const std::uint32_t b = place_[indices[t + (c + 1) % 3]];
        if (a == kNone || b == kNone || a == b || (sides_[a] & sides_[b]) == 0) continue;
        const std::uint64_t low = std::min(a, b), high = std::max(a, b);
        steps.push_back({low << 32U | high, a < b ? 1 : -1});
      }
    }
    return summed(std::move(steps));
  }

 private:
  struct Vertex {
    Position position;
    std::uint32_t number;
    std::uint8_t sides;
  };

  /// An edge of a triangle: its smaller place and its greater one, 32 bits each; -1: reversed.
  struct Step {
    std::uint64_t places = 0;
    int count = 0;
  };

  void weld(std::vector<Vertex>& vertices) {
    std::ranges::sort(vertices, {},
                      [](const Vertex& v) { return std::pair(v.position, v.number); });
    for (const Vertex& vertex : vertices) {
      if (positions_.empty() || positions_.back() != vertex.position) {
        positions_.push_back(vertex.position);
        sides_.push_back(vertex.sides);
        first_.push_back(static_cast<std::uint32_t>(vertices_.size()));
      }
      place_[vertex.number] = static_cast<std::uint32_t>(positions_.size() - 1);
      vertices_.push_back(vertex.number);
    }
    first_.push_back(static_cast<std::uint32_t>(vertices_.size()));
  }

  /// Adds up the edges between the same places, and drops those that have an opposite one.
  static std::vector<OpenEdge> summed(std::vector<Step> steps) {
    std::ranges::sort(steps, {}, &Step::places);
    std::vector<OpenEdge> open;
    for (std::size_t n = 0; n < steps.size();) {
      const std::uint64_t places = steps[n].places;
      OpenEdge sum{static_cast<std::uint32_t>(places >> 32U), static_cast<std::uint32_t>(places),
                   0};
      for (; n < steps.size() && steps[n].places == places; ++n) sum.count += steps[n].count;
      if (sum.count < 0) sum = {sum.to, sum.from, -sum.count};
      if (sum.count != 0) open.push_back(sum);
    }
    return open;
  }

  std::vector<std::uint32_t> place_;     ///< by vertex; kNone outside the border cells
  std::vector<Position> positions_;      ///< by place, ascending
  std::vector<std::uint8_t> sides_;      ///< by place
  std::vector<std::uint32_t> first_;     ///< by place, and one more: in vertices_
  std::vector<std::uint32_t> vertices_;  ///< by place
};

double distance_to_segment(const Position& p, const Position& a, const Position& b) {
  const auto vec = [](const Position& q) { return Vec3{double(q[0]), double(q[1]), double(q[2])}; };
  const Vec3 along = vec(b) - vec(a), from = vec(p) - vec(a);
  const double square = dot(along, along);
  const double share = square > 0 ? std::clamp(dot(from, along) / square, 0.0, 1.0) : 0;
  return length(from - along * share);
}

/// Simplifies the chains of open edges between junctions into segments that replace several edges.
/// They depend only on data that both tiles have, so they are the same in both.
class BorderSegments {
 public:
  BorderSegments(const Border& border, std::span<const OpenEdge> open_edges,
                 const std::array<double, 4>& error_mm)
      : border_(border), error_mm_(error_mm), passed_(border.places()) {
    connect(open_edges);
    for (std::uint32_t p = 0; p < passed_.size(); ++p) {
      if (next(p).empty() || !is_junction(p)) continue;
      for (const std::uint32_t q : next(p)) {
        if (q != kNone && !is_junction(q) && !passed_[q]) collapse(walk(p, q));
      }
    }
    // The remaining chains are rings without a junction. Their smallest place serves as one.
    for (std::uint32_t p = 0; p < passed_.size(); ++p) {
      if (!next(p).empty() && !is_junction(p) && !passed_[p]) collapse(walk(p, next(p)[0]));
    }
  }

  /// The places of each segment: its ends, with the dropped places in between.
  const std::vector<std::vector<std::uint32_t>>& segments() const { return segments_; }

 private:
  void connect(std::span<const OpenEdge> open_edges) {
    first_.resize(passed_.size() + 1);
    // Places where the surface touches itself become junctions, which do not move.
    const auto ends = [](const OpenEdge& edge) { return edge.count == 1 ? 1U : 2U; };
    for (const OpenEdge& edge : open_edges) {
      for (const std::uint32_t p : {edge.from, edge.to}) first_[p + 1] += ends(edge);
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    next_.assign(first_.back(), kNone);
    std::vector<std::uint32_t> end(first_);
    for (const OpenEdge& edge : open_edges) {
      for (const auto& [a, b] : {std::pair{edge.from, edge.to}, {edge.to, edge.from}}) {
        next_[end[a]] = b;
        end[a] += ends(edge);
      }
    }
  }

  /// The neighbors of `p` along open edges; kNone for a second edge to the previous one.
  std::span<const std::uint32_t> next(std::uint32_t p) const {
    return std::span(next_).subspan(first_[p], first_[p + 1] - first_[p]);
  }

  bool is_junction(std::uint32_t p) const {
    return next(p).size() != 2 || !std::has_single_bit(border_.sides(p));
  }

  std::vector<std::uint32_t> walk(std::uint32_t start, std::uint32_t second) {
    std::vector<std::uint32_t> chain{start};
    passed_[start] = true;
    std::uint32_t before = start, here = second;
    while (!is_junction(here) && here != start) {
      passed_[here] = true;
      chain.push_back(here);
      const auto both = next(here);
      before = std::exchange(here, both[0] == before ? both[1] : both[0]);
    }
    chain.push_back(here);
    // Normalize the direction: places are numbered by position, so both tiles choose the same one.
    if (std::ranges::lexicographical_compare(
            chain, std::vector<std::uint32_t>(chain.rbegin(), chain.rend()))) {
      return chain;
    }
    std::ranges::reverse(chain);
    return chain;
  }

  /// Simplifies a chain (Douglas and Peucker 1973).
  void collapse(const std::vector<std::uint32_t>& chain) {
    const auto side = static_cast<std::size_t>(std::countr_zero(border_.sides(chain[1])));
    if (error_mm_[side] <= 0) return;
    std::vector<bool> kept(chain.size());
    kept.front() = kept.back() = true;
    std::vector<std::pair<std::size_t, std::size_t>> open{{0, chain.size() - 1}};
    while (!open.empty()) {
      const auto [first, last] = open.back();
      open.pop_back();
      double worst = error_mm_[side];
      std::size_t split = 0;
      for (std::size_t n = first + 1; n < last; ++n) {
        const double off =
            distance_to_segment(border_.position(chain[n]), border_.position(chain[first]),
                                border_.position(chain[last]));
        if (off > worst) {
          worst = off;
          split = n;
        }
      }
      if (split == 0) continue;
      kept[split] = true;
      open.push_back({first, split});
      open.push_back({split, last});
    }
    for (std::size_t first = 0, last = 1; last < chain.size(); ++last) {
      if (!kept[last]) continue;
      const auto at = [&](std::size_t n) { return chain.begin() + static_cast<std::ptrdiff_t>(n); };
      if (last > first + 1) segments_.emplace_back(at(first), at(last + 1));
      first = last;
    }
  }

  const Border& border_;
  const std::array<double, 4>& error_mm_;
  std::vector<std::vector<std::uint32_t>> segments_;
  std::vector<bool> passed_;
  std::vector<std::uint32_t> first_;  ///< by place, and one more: in next_
  std::vector<std::uint32_t> next_;
};

Vec3 area_vector(const Position& a, const Position& b, const Position& c) {
  const auto vec = [](const Position& q) { return Vec3{double(q[0]), double(q[1]), double(q[2])}; };
  return cross(vec(b) - vec(a), vec(c) - vec(a));
}

/// Moves the places that segments drop to one of the two ends. The first of them move to the first
/// end, the rest to the second, and the resulting edge does not depend on where the two parts meet.
/// So each tile chooses the split so that no triangle flips, because a flipped triangle would cover
/// its neighbors.
class BorderMove {
 public:
  BorderMove(const TileMesh& mesh, const Border& border)
      : mesh_(mesh), border_(border), target_(border.places()), first_(border.places() + 1) {
    std::iota(target_.begin(), target_.end(), 0U);
    each_corner([&](std::uint32_t place, std::uint32_t) { ++first_[place + 1]; });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    triangles_.resize(first_.back());
    std::vector<std::uint32_t> end(first_);
    each_corner([&](std::uint32_t place, std::uint32_t t) { triangles_[end[place]++] = t; });
  }

  void collapse(std::span<const std::uint32_t> segment) {
    const std::size_t inner = segment.size() - 2;
    std::size_t best = inner / 2;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t n = 0; n <= inner && least > 0; ++n) {
      // From the middle outwards.
      const std::size_t split = n % 2 == 0 ? inner / 2 - n / 2 : inner / 2 + (n + 1) / 2;
      move(segment, split);
      const double turned = turned_over(segment);
      if (turned >= least) continue;
      least = turned;
      best = split;
    }
    move(segment, best);
  }

  std::uint32_t target(std::uint32_t place) const { return target_[place]; }

 private:
  void each_corner(const auto& take) const {
    for (std::uint32_t t = 0; t < mesh_.indices.size(); t += 3) {
      for (std::uint32_t c = 0; c < 3; ++c) {
        const std::uint32_t place = border_.place(mesh_.indices[t + c]);
        if (place != kNone) take(place, t);
      }
    }
  }

  void move(std::span<const std::uint32_t> segment, std::size_t split) {
    for (std::size_t n = 1; n + 1 < segment.size(); ++n) {
      target_[segment[n]] = n <= split ? segment.front() : segment.back();
    }
  }

  const Position& moved(std::uint32_t vertex) const {
    const std::uint32_t place = border_.place(vertex);
    return place == kNone ? mesh_.positions_mm[vertex] : border_.position(target_[place]);
  }

  /// Twice the area of the triangles at the inner places that have turned over.
  double turned_over(std::span<const std::uint32_t> segment) const {
    double turned = 0;
    for (const std::uint32_t place : segment.subspan(1, segment.size() - 2)) {
      for (std::uint32_t n = first_[place]; n < first_[place + 1]; ++n) {
        const std::uint32_t t = triangles_[n];
        const auto corner = std::span(mesh_.indices).subspan(t, 3);
        const Vec3 now = area_vector(moved(corner[0]), moved(corner[1]), moved(corner[2]));
        const auto& at = mesh_.positions_mm;
        const Vec3 before = area_vector(at[corner[0]], at[corner[1]], at[corner[2]]);
        const double area = length(now);
        if (area > 0 && dot(now, before) <= kTurnedCos * area * length(before)) turned += area;
      }
    }
    return turned;
  }

  /// Triangles that turn by more count as flipped.
  static constexpr double kTurnedCos = 0.3;

  const TileMesh& mesh_;
  const Border& border_;
  std::vector<std::uint32_t> target_;     ///< by place: its replacement
  std::vector<std::uint32_t> first_;      ///< by place, and one more: in triangles_
  std::vector<std::uint32_t> triangles_;  ///< first of their three indices, by place
};

/// Returns the vertex of `place` whose normal is closest to that of vertex `v`, preferring vertices
/// that are original, or cut, like `v`.
std::uint32_t like(const TileMesh& mesh, const Border& border, std::uint32_t place,
                   std::uint32_t v) {
  const auto& n = mesh.normals[v];
  return std::ranges::max(border.vertices(place), {}, [&](std::uint32_t candidate) {
    const bool is_same = mesh.original[candidate] == mesh.original[v];
    return std::pair(is_same, dot(n, mesh.normals[candidate]));
  });
}

}  // namespace

TileMesh with_coarser_borders(const TileMesh& mesh, const DexelGrid& grid,
                              const std::array<double, 4>& side_error_mm) {
  const Border border(mesh, grid);
  const BorderSegments simpler(border, border.open_edges(mesh.indices), side_error_mm);
  BorderMove move(mesh, border);
  for (const auto& segment : simpler.segments()) move.collapse(segment);
  std::vector<std::uint32_t> moved(mesh.positions_mm.size());
  for (std::uint32_t v = 0; v < moved.size(); ++v) {
    const std::uint32_t place = border.place(v);
    const bool stays = place == kNone || move.target(place) == place;
    moved[v] = stays ? v : like(mesh, border, move.target(place), v);
  }
  TileMesh out{mesh.tile, mesh.positions_mm, mesh.normals, {}, mesh.original};
  out.indices.reserve(mesh.indices.size());
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    const std::array<std::uint32_t, 3> corners{moved[mesh.indices[t]], moved[mesh.indices[t + 1]],
                                               moved[mesh.indices[t + 2]]};
    const auto at = [&](std::size_t c) { return out.positions_mm[corners[c]]; };
    if (at(0) == at(1) || at(1) == at(2) || at(2) == at(0)) continue;
    out.indices.insert(out.indices.end(), corners.begin(), corners.end());
  }
  return out;
}

bool same_border(const TileMesh& mesh, std::span<const std::uint32_t> indices,
                 const DexelGrid& grid) {
  const Border border(mesh, grid);
  return border.open_edges(mesh.indices) == border.open_edges(indices);
}

}  // namespace kerf
