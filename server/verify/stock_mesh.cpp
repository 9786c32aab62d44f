// SPDX-License-Identifier: Apache-2.0
#include "server/verify/stock_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "kernel/dexel/mesh_stock.h"
#include "kernel/math/nearest_on_triangle.h"

namespace kerf {
namespace {

// Consecutive triangles are near each other.
constexpr std::uint32_t kTrianglesPerRun = 8;
// Cells of the grid per triangle, and at most.
constexpr double kCellsPerTriangle = 0.5;
constexpr double kCellsMax = 1 << 20;
// A point this near to the surface has no direction, mm.
constexpr double kOnSurfaceMm = 1e-9;

Vec3 twice_area(const std::array<Vec3, 3>& c) { return cross(c[1] - c[0], c[2] - c[0]); }

// Whether the line along Z through p crosses an edge's projection to its left. Edges that share an
// end are crossed once (kernel/dexel/mesh_stock.cpp).
bool crosses(const Vec3& a, const Vec3& b, Vec3 p) {
  if ((a.y > p.y) == (b.y > p.y)) return false;
  const Vec3 &low = b.y > p.y ? a : b, &high = b.y > p.y ? b : a;
  return (p.x - low.x) * (high.y - low.y) < (high.x - low.x) * (p.y - low.y);
}

}  // namespace

StockMesh::StockMesh(const TriangleMesh& mesh) : origin_mm_(mesh_bounds(mesh).min_mm), mesh_(mesh) {
  for (Vec3& vertex : mesh_.vertices_mm) vertex = vertex - origin_mm_;
  double area = 0;
  Vec3 size;
  std::vector<Box> boxes;
  boxes.reserve(mesh_.triangles.size());
  until_mm2_.reserve(mesh_.triangles.size());
  for (std::size_t n = 0; n < mesh_.triangles.size(); ++n) {
    const auto c = corners(n);
    until_mm2_.push_back(area += length(twice_area(c)) / 2);
    boxes.push_back(around(around({c[0], c[0]}, {c[1], c[1]}), {c[2], c[2]}));
    const Vec3& high = boxes.back().high;
    size = {std::max(size.x, high.x), std::max(size.y, high.y), 0};
  }
  tree_ = BoxTree(std::move(boxes), kTrianglesPerRun);
  index_cells(size);
}

// Counts the triangles over each cell, then lists them.
void StockMesh::index_cells(Vec3 size) {
  const double cells =
      std::clamp(kCellsPerTriangle * double(mesh_.triangles.size()), 1.0, kCellsMax);
  cell_mm_ =
      std::max({std::sqrt(size.x * size.y / cells), size.x / cells, size.y / cells, kOnSurfaceMm});
  cells_x_ = 1 + static_cast<std::size_t>(size.x / cell_mm_);
  cells_y_ = 1 + static_cast<std::size_t>(size.y / cell_mm_);
  const auto for_cells = [&](std::size_t n, auto&& use) {
    const auto c = corners(n);
    const double x0 = std::min({c[0].x, c[1].x, c[2].x}), x1 = std::max({c[0].x, c[1].x, c[2].x});
    const double y0 = std::min({c[0].y, c[1].y, c[2].y}), y1 = std::max({c[0].y, c[1].y, c[2].y});
    for (std::size_t y = cell(y0, cells_y_); y <= cell(y1, cells_y_); ++y)
      for (std::size_t x = cell(x0, cells_x_); x <= cell(x1, cells_x_); ++x) use(y * cells_x_ + x);
  };
  first_.assign(cells_x_ * cells_y_ + 1, 0);
  for (std::size_t n = 0; n < mesh_.triangles.size(); ++n)
    for_cells(n, [&](std::size_t at) { ++first_[at + 1]; });
  for (std::size_t at = 1; at < first_.size(); ++at) first_[at] += first_[at - 1];
  over_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t n = 0; n < mesh_.triangles.size(); ++n)
    for_cells(n, [&](std::size_t at) { over_[next[at]++] = static_cast<std::uint32_t>(n); });
}

std::array<Vec3, 3> StockMesh::corners(std::size_t triangle) const {
  const auto& t = mesh_.triangles[triangle];
  return {mesh_.vertices_mm[t[0]], mesh_.vertices_mm[t[1]], mesh_.vertices_mm[t[2]]};
}

std::size_t StockMesh::cell(double mm, std::size_t cells) const {
  return static_cast<std::size_t>(std::clamp(mm / cell_mm_, 0.0, static_cast<double>(cells - 1)));
}

bool StockMesh::contains(Vec3 point_mm) const {
  const Vec3 p = point_mm - origin_mm_;
  const std::size_t at = cell(p.y, cells_y_) * cells_x_ + cell(p.x, cells_x_);
  int winding = 0;
  for (std::uint32_t k = first_[at]; k < first_[at + 1]; ++k) {
    const auto c = corners(over_[k]);
    int crossed = 0;
    for (std::size_t n = 0; n < 3; ++n)
      if (crosses(c[n], c[(n + 1) % 3], p)) crossed += c[(n + 1) % 3].y > c[n].y ? 1 : -1;
    if (crossed == 0) continue;
    const Vec3 normal = twice_area(c);
    const double z = c[0].z - (normal.x * (p.x - c[0].x) + normal.y * (p.y - c[0].y)) / normal.z;
    if (z > p.z) winding += crossed;
  }
  return winding != 0;
}

StockMesh::Nearest StockMesh::nearest(Vec3 point_mm, double limit_mm) const {
  const Vec3 p = point_mm - origin_mm_;
  double least = limit_mm;
  std::uint32_t nearest = 0;
  Vec3 out;
  tree_.visit_nearest(p, least, [&](std::uint32_t n) {
    const Vec3 away = p - nearest_on_triangle(corners(n), p).point;
    const double mm = length(away);
    if (!(mm < least)) return;  // NaN: a triangle without area, whose neighbors contain its points
    least = mm;
    nearest = n;
    out = away;
  });
  if (least <= kOnSurfaceMm) return {0, normalized(twice_area(corners(nearest)))};
  const double sign = contains(point_mm) ? -1 : 1;
  return {sign * least, out * (sign / least)};
}

StockMesh::SurfacePoint StockMesh::at(double at_mm2, double a, double b) const {
  const auto found = std::ranges::upper_bound(until_mm2_, at_mm2);
  const auto n =
      std::min(static_cast<std::size_t>(found - until_mm2_.begin()), mesh_.triangles.size() - 1);
  const auto c = corners(n);
  const double root = std::sqrt(a);
  const Vec3 p = c[0] * (1 - root) + c[1] * (root * (1 - b)) + c[2] * (root * b);
  return {origin_mm_ + p, normalized(twice_area(c))};
}

}  // namespace kerf
