// SPDX-License-Identifier: Apache-2.0
#include "server/feed/quad_merge.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <span>
#include <utility>

#include "server/feed/float3.h"
#include "server/feed/step_join.h"
#include "server/feed/tile_cells.h"

namespace kerf {
namespace {

/// Vertices on a side of the lattice: one in each cell.
constexpr int kSide = kCellsOfTile;
constexpr std::uint32_t kNoVertex = ~std::uint32_t{0};
constexpr float kKept = std::numeric_limits<float>::infinity();  ///< a vertex that must stay
/// Greatest sideways distance of a dropped vertex from the middle of its neighbors, pitches. In a
/// smooth surface each vertex is near the middle of its cell.
constexpr float kBesideMax = 0.5F;

/// Index of a cell in an array of the lattice.
constexpr std::size_t at(int x, int y) {
  return static_cast<std::size_t>(y) * kSide + static_cast<std::size_t>(x);
}

/// Triangles that connect the vertices of four cells, counter-clockwise seen from outside.
struct Quad {
  std::array<std::uint32_t, 4> corner{kNoVertex, kNoVertex, kNoVertex, kNoVertex};
  std::array<std::uint32_t, 2> triangle{kNoVertex, kNoVertex};
  std::uint8_t triangles = 0;
  std::uint8_t missing = 0;  ///< bit n: a triangle is without corner n
  bool fits = true;          ///< its triangles have the same corners

  /// Two triangles on the two sides of a diagonal.
  bool is_whole() const {
    return fits && triangles == 2 && (missing == 0b0101 || missing == 0b1010);
  }
};

/// The quadrangles of a tile that face up, or those that face down, as a height field.
class Sheet {
 public:
  Sheet(const TileMesh& mesh, std::span<const std::uint32_t> indices, double pitch_mm,
        float error_mm, float turn, bool faces_up)
      : mesh_(mesh),
        indices_(indices),
        beside_max_mm_(kBesideMax * static_cast<float>(pitch_mm)),
        error_mm_(error_mm),
        turn_max_(turn),
        faces_up_(faces_up) {}

  /// Adds a triangle if it is half a quadrangle of the sheet. `corner`: number of each vertex's
  /// cell in the quadrangle at `low`, in the order of Quad.
  void add(std::uint32_t triangle, const std::array<unsigned, 3>& corner, TileCell low) {
    Quad& quad = quads_[at(low.x, low.y)];
    unsigned present = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      std::uint32_t& vertex = quad.corner[corner[c]];
      const std::uint32_t own = indices_[std::size_t{3} * triangle + c];
      if (vertex != kNoVertex && vertex != own) quad.fits = false;
      vertex = own;
      present |= 1U << corner[c];
    }
    if (quad.triangles == 2) {
      quad.fits = false;
      return;
    }
    quad.missing |= static_cast<std::uint8_t>(0b1111U & ~present);
    quad.triangle[quad.triangles++] = triangle;
  }

  /// Appends the triangles that replace the quadrangles, and marks the replaced ones in
  /// `is_replaced`.
  void merge(std::vector<std::uint32_t>& indices, std::vector<bool>& is_replaced) {
    if (!take_vertices()) return;
    estimate();
    for (int y = 0; y < kTileSide; ++y) {
      for (int x = 0; x < kTileSide; ++x) {
        if (!is_taken_[at(x, y)]) continue;
        for (const std::uint32_t triangle : quads_[at(x, y)].triangle) is_replaced[triangle] = true;
      }
    }
    divide({0, 0}, {kTileSide, kTileSide}, {kTileSide, 0}, indices);
    divide({kTileSide, kTileSide}, {0, 0}, {0, kTileSide}, indices);
  }

 private:
  /// Finds the vertex of each cell. Returns whether any may be dropped: one shared by four whole
  /// quadrangles.
  bool take_vertices() {
    vertex_.fill(kNoVertex);
    error_.fill(kKept);
    for (int y = 0; y < kTileSide; ++y) {
      for (int x = 0; x < kTileSide; ++x) {
        const Quad& quad = quads_[at(x, y)];
        is_taken_[at(x, y)] = quad.is_whole() && is_even(quad);
        if (!is_taken_[at(x, y)]) continue;
        const std::array<std::size_t, 4> cells{at(x, y), at(x + 1, y), at(x + 1, y + 1),
                                               at(x, y + 1)};
        for (std::size_t n = 0; n < 4; ++n) {
          std::uint32_t& vertex = vertex_[cells[n]];
          if (vertex == kNoVertex) vertex = quad.corner[n];
          // The cell has a vertex of another sheet, so this quadrangle stays.
          if (vertex != quad.corner[n]) is_taken_[at(x, y)] = false;
        }
      }
    }
    bool any = false;
    for (int y = 1; y < kTileSide; ++y) {
      for (int x = 1; x < kTileSide; ++x) {
        const bool inside = is_taken_[at(x - 1, y - 1)] && is_taken_[at(x, y - 1)] &&
                            is_taken_[at(x - 1, y)] && is_taken_[at(x, y)];
        const bool plain = inside && is_plain(quads_[at(x - 1, y - 1)]) &&
                           is_plain(quads_[at(x, y - 1)]) && is_plain(quads_[at(x - 1, y)]) &&
                           is_plain(quads_[at(x, y)]);
        if (plain) error_[at(x, y)] = 0;
        any = any || plain;
      }
    }
    return any;
  }

  /// Whether all of it is original, or all is cut.
  bool is_plain(const Quad& quad) const {
    const std::uint8_t first = mesh_.original[quad.corner[0]];
    return std::ranges::all_of(
        quad.corner, [&](std::uint32_t vertex) { return mesh_.original[vertex] == first; });
  }

  /// Whether the surface is nearly the same with the other diagonal.
  bool is_even(const Quad& quad) const {
    const auto p = [&](std::size_t n) { return mesh_.positions_mm[quad.corner[n]]; };
    const Float3 first = minus(p(0), p(1)), second = minus(p(2), p(3));
    const Float3& normal = mesh_.normals[quad.corner[0]];
    return std::abs(dot(normal, first) + dot(normal, second)) <= 2 * error_mm_;
  }

  /// Distance of a vertex from the middle between two others along its normal, mm; kKept if it is
  /// too far sideways.
  float distance(std::size_t middle, std::size_t a, std::size_t b) const {
    const auto p = [&](std::size_t cell) { return mesh_.positions_mm[vertex_[cell]]; };
    const Float3 first = minus(p(middle), p(a)), second = minus(p(middle), p(b));
    const Float3 twice{first[0] + second[0], first[1] + second[1], first[2] + second[2]};
    const float along = dot(twice, mesh_.normals[vertex_[middle]]) / 2;
    const float beside = dot(twice, twice) / 4 - along * along;
    return beside > beside_max_mm_ * beside_max_mm_ ? kKept : std::abs(along);
  }

  /// Difference of a vertex's normal from the normal interpolated between two others.
  float turn(std::size_t middle, std::size_t a, std::size_t b) const {
    const auto n = [&](std::size_t cell) { return mesh_.normals[vertex_[cell]]; };
    const Float3 first = minus(n(middle), n(a)), second = minus(n(middle), n(b));
    const Float3 twice{first[0] + second[0], first[1] + second[1], first[2] + second[2]};
    return std::sqrt(dot(twice, twice)) / 2;
  }

  /// Sets the error and turn of dropping a vertex: its own, plus the greatest of its dependents,
  /// the middles of the next finer triangles.
  void set_error(TileCell middle, TileCell off_a, std::initializer_list<TileCell> finer) {
    const std::size_t m = at(middle.x, middle.y);
    if (error_[m] == kKept) return;
    float below = 0, turned = 0;
    for (const TileCell& cell : finer) {
      below = std::max(below, error_[at(cell.x, cell.y)]);
      turned = std::max(turned, turn_[at(cell.x, cell.y)]);
    }
    if (below <= error_mm_) {
      const std::size_t a = at(middle.x - off_a.x, middle.y - off_a.y);
      const std::size_t b = at(middle.x + off_a.x, middle.y + off_a.y);
      below += distance(m, a, b);
      turned += turn(m, a, b);
    }
    error_[m] = below <= error_mm_ && turned <= turn_max_ ? below : kKept;
    turn_[m] = turned;
  }

  /// Estimates errors from the finest triangles to the coarsest. `s`: half the side of a square.
  void estimate() {
    for (int s = 1; s < kTileSide; s *= 2) {
      const int h = s / 2;
      // Middles of sides; the finest ones have no dependents.
      for (int y = 0; y < kSide; y += s) {
        for (int x = 0; x < kSide; x += s) {
          const bool along_x = x / s % 2 == 1 && y / s % 2 == 0;
          if (!along_x && !(y / s % 2 == 1 && x / s % 2 == 0)) continue;
          if (x == 0 || y == 0 || x == kTileSide || y == kTileSide) continue;
          const TileCell off = along_x ? TileCell{s, 0} : TileCell{0, s};
          if (h == 0) {
            set_error({x, y}, off, {});
          } else {
            set_error({x, y}, off,
                      {{x - h, y - h}, {x + h, y - h}, {x - h, y + h}, {x + h, y + h}});
          }
        }
      }
      for (int y = s; y < kTileSide; y += 2 * s) {
        for (int x = s; x < kTileSide; x += 2 * s) {
          // The diagonal passes through the middle of the square of which this one is a quarter.
          const bool rises = (x / s / 2 + y / s / 2) % 2 == 0;
          set_error({x, y}, {s, rises ? s : -s}, {{x - s, y}, {x + s, y}, {x, y - s}, {x, y + s}});
        }
      }
    }
  }

  /// Appends the right triangle with the hypotenuse from a to b, or its halves.
  void divide(TileCell a, TileCell b, TileCell c, std::vector<std::uint32_t>& indices) const {
    if (std::abs(a.x - c.x) + std::abs(a.y - c.y) > 1) {
      const TileCell middle{(a.x + b.x) / 2, (a.y + b.y) / 2};
      if (error_[at(middle.x, middle.y)] == kKept) {
        divide(c, a, middle, indices);
        divide(b, c, middle, indices);
        return;
      }
    } else if (!is_taken_[at(std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}))]) {
      return;
    }
    if (!faces_up_) std::swap(a, b);
    for (const TileCell& cell : {a, c, b}) indices.push_back(vertex_[at(cell.x, cell.y)]);
  }

  const TileMesh& mesh_;
  std::span<const std::uint32_t> indices_;
  float beside_max_mm_;
  float error_mm_;
  float turn_max_;
  bool faces_up_;
  std::array<Quad, std::size_t{kSide} * kSide> quads_{};  ///< by their lowest cell
  std::array<bool, std::size_t{kSide} * kSide> is_taken_{};
  std::array<std::uint32_t, std::size_t{kSide} * kSide> vertex_{};  ///< by cell
  std::array<float, std::size_t{kSide} * kSide> error_{};           ///< by cell; kKept: must stay
  std::array<float, std::size_t{kSide} * kSide> turn_{};            ///< by cell
};

/// Indices of a triangle's corners in the quadrangle at `low`, and its orientation.
struct Half {
  std::array<unsigned, 3> corner{};
  TileCell low;
  bool faces_up = false;
};

/// Returns false if the triangle is not half a quadrangle of four cells.
bool find_half(const std::array<TileCell, 3>& cells, Half& half) {
  half.low = {std::min({cells[0].x, cells[1].x, cells[2].x}),
              std::min({cells[0].y, cells[1].y, cells[2].y})};
  if (half.low.x < 0) return false;
  unsigned present = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const int x = cells[c].x - half.low.x, y = cells[c].y - half.low.y;
    if (x > 1 || y > 1) return false;
    half.corner[c] = static_cast<unsigned>(y == 0 ? x : 3 - x);
    present |= 1U << half.corner[c];
  }
  if (!std::has_single_bit(0b1111U ^ present)) return false;
  // Counter-clockwise, the steps to the second corner and on to the third add up to at most three.
  const unsigned step = (half.corner[1] - half.corner[0]) & 3U;
  const unsigned next = (half.corner[2] - half.corner[1]) & 3U;
  half.faces_up = step + next <= 3;
  return true;
}

}  // namespace

std::vector<std::uint32_t> merged_quads(const TileMesh& mesh, const DexelGrid& grid,
                                        const MergeBound& bound) {
  const std::vector<TileCell> cells = cells_of(mesh, grid.pitch_mm);
  const auto half_error_mm = static_cast<float>(bound.error_mm / 2);
  const auto turn = static_cast<float>(bound.turn);
  const std::vector<std::uint32_t> joined =
      joined_steps(mesh, cells, grid.pitch_mm, half_error_mm / 2);
  Sheet up(mesh, joined, grid.pitch_mm, half_error_mm, turn, true);
  Sheet down(mesh, joined, grid.pitch_mm, half_error_mm, turn, false);
  const std::size_t triangles = joined.size() / 3;
  for (std::size_t t = 0; t < triangles; ++t) {
    const auto cell = [&](std::size_t c) { return cells[joined[3 * t + c]]; };
    Half half;
    if (!find_half({cell(0), cell(1), cell(2)}, half)) continue;
    (half.faces_up ? up : down).add(static_cast<std::uint32_t>(t), half.corner, half.low);
  }
  std::vector<std::uint32_t> merged;
  std::vector<bool> is_replaced(triangles);
  up.merge(merged, is_replaced);
  down.merge(merged, is_replaced);
  std::vector<std::uint32_t> indices;
  indices.reserve(joined.size());
  for (std::size_t t = 0; t < triangles; ++t) {
    if (is_replaced[t]) continue;
    for (std::size_t c = 0; c < 3; ++c) indices.push_back(joined[3 * t + c]);
  }
  indices.insert(indices.end(), merged.begin(), merged.end());
  return indices;
}

}  // namespace kerf
