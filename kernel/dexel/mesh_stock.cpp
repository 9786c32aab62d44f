// SPDX-License-Identifier: Apache-2.0
#include "kernel/dexel/mesh_stock.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "kernel/dexel/dexel_tile.h"
#include "kernel/dexel/mesh_shares.h"

namespace kerf {
namespace {

/// A crossing of a ray with a triangle.
struct Hit {
  std::int32_t column;  ///< i + columns_x * row, in RowsOfMesh
  std::int32_t depth;   ///< quanta
  std::int32_t winding;
  NormalCode code;

  friend bool operator<(const Hit& a, const Hit& b) {
    return a.column != b.column ? a.column < b.column : a.depth < b.depth;
  }
};

using Corners = std::array<Vec3, 3>;

class Dexelizer {
 public:
  Dexelizer(const TriangleMesh& mesh, const DexelGrid& grid, bool keep_normals)
      : mesh_(mesh), grid_(grid), keep_normals_(keep_normals) {
    bands_.resize(std::size_t(grid.tiles_y()));
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto [first, last] = rows_of(corners(t));
      if (first > last) continue;
      const std::int32_t end = std::min(last + kMargin, grid_.columns_y - 1) / kTileSide;
      for (std::int32_t band = std::max(first - kMargin, 0) / kTileSide; band <= end; ++band)
        bands_[std::size_t(band)].push_back(t);
    }
  }

  /// Creates the tiles of one row of tiles.
  template <class Put>
  void run(std::int32_t band, Put&& put) {
    hits_.clear();
    rows_.first_row = band * kTileSide - kMargin;
    for (const std::uint32_t t : bands_[std::size_t(band)]) meet(corners(t));
    std::stable_sort(hits_.begin(), hits_.end());
    starts_.assign(std::size_t(grid_.columns_x) * RowsOfMesh::kRows + 1, 0);
    for (const Hit& hit : hits_) ++starts_[std::size_t(hit.column) + 1];
    for (std::size_t n = 1; n < starts_.size(); ++n) starts_[n] += starts_[n - 1];
    for (std::int32_t x = 0; x < grid_.tiles_x(); ++x) {
      if (auto tile = make_tile({x, band})) put(TileIndex{x, band}, std::move(tile));
    }
  }

  /// Computes the shares of the columns of the row that run() created.
  void add_shares(std::int32_t band, const ColumnShares& sides,
                  std::map<TileIndex, ColumnShares::OfTile>& shares) {
    measure_rows();
    MeshShares near_walls(grid_, rows_);
    for (const std::uint32_t t : bands_[std::size_t(band)]) near_walls.add(corners(t));
    ColumnShares::OfTile of_tile;
    for (std::int32_t x = 0; x < grid_.tiles_x(); ++x) {
      const TileIndex tile{x, band};
      if (near_walls.of_tile(tile, sides, of_tile)) shares.emplace(tile, of_tile);
    }
  }

 private:
  static constexpr std::int32_t kMargin = RowsOfMesh::kMargin;

  Corners corners(std::uint32_t triangle) const {
    Corners c;
    for (std::size_t n = 0; n < 3; ++n) {
      c[n] = to_frame(grid_.axis, mesh_.vertices_mm[mesh_.triangles[triangle][n]]);
    }
    return c;
  }

  /// Returns the first and last row that the triangle may reach; first > last if it reaches none.
  std::pair<std::int32_t, std::int32_t> rows_of(const Corners& c) const {
    const auto row = [&](double y) {
      const double n = (y - grid_.origin_mm.y) / grid_.pitch_mm - 0.5;
      return std::clamp(n, -2.0, double(grid_.columns_y) + 1);
    };
    const auto low = static_cast<std::int32_t>(std::floor(row(std::min({c[0].y, c[1].y, c[2].y}))));
    const auto high = static_cast<std::int32_t>(std::ceil(row(std::max({c[0].y, c[1].y, c[2].y}))));
    return {std::max(low, 0), std::min(high, grid_.columns_y - 1)};
  }

  void meet(const Corners& c) {
    const auto [first, last] = rows_of(c);
    const std::int32_t begin = std::max(first, rows_.first_row);
    const std::int32_t end = std::min(last, rows_.first_row + RowsOfMesh::kRows - 1);
    for (std::int32_t j = begin; j <= end; ++j) {
      const double y = grid_.y_mm(j);
      // A row crosses either no edge of the triangle, or two: one upward and one downward.
      std::int32_t up = 0, down = 0;
      for (std::size_t n = 0; n < 3; ++n) {
        const Vec3 &a = c[n], &b = c[(n + 1) % 3];
        if ((a.y > y) == (b.y > y)) continue;
        (b.y > y ? up : down) = columns_left_of(b.y > y ? a : b, b.y > y ? b : a, y);
      }
      for (std::int32_t i = std::min(up, down); i < std::max(up, down); ++i) {
        const std::int32_t column = (j - rows_.first_row) * grid_.columns_x + i;
        hits_.push_back({column, depth_at(c, grid_.x_mm(i), y), up > down ? 1 : -1, code_of(c)});
      }
    }
  }

  /// Counts the columns of a row to the left of an edge that crosses it upward. The compared
  /// expression is monotone in the column index, in floating point too, so the columns on the left
  /// are a prefix of the row.
  std::int32_t columns_left_of(Vec3 low, Vec3 high, double y) const {
    const double rise = high.y - low.y, along = (high.x - low.x) * (y - low.y);
    const auto is_left = [&](std::int32_t i) { return (grid_.x_mm(i) - low.x) * rise < along; };
    const double guess = (low.x + along / rise - grid_.origin_mm.x) / grid_.pitch_mm - 0.5;
    auto i = static_cast<std::int32_t>(std::clamp(guess, 0.0, double(grid_.columns_x)));
    while (i < grid_.columns_x && is_left(i)) ++i;
    while (i > 0 && !is_left(i - 1)) --i;
    return i;
  }

  std::int32_t depth_at(const Corners& c, double x, double y) const {
    const Vec3 n = cross(c[1] - c[0], c[2] - c[0]);
    const double low = std::min({c[0].z, c[1].z, c[2].z}),
                 high = std::max({c[0].z, c[1].z, c[2].z});
    double z = c[0].z - (n.x * (x - c[0].x) + n.y * (y - c[0].y)) / n.z;
    // A ray may graze an upright triangle; n.z is then 0 and z infinite or NaN.
    z = z >= low ? std::min(z, high) : low;
    const double quanta = (z - grid_.origin_mm.z) / grid_.z_quantum_mm;
    return static_cast<std::int32_t>(std::clamp(quanta, 0.0, double(grid_.height_quanta)) + 0.5);
  }

  NormalCode code_of(const Corners& c) const {
    if (!keep_normals_) return kStockNormal;
    const Vec3 n = normalized(cross(c[1] - c[0], c[2] - c[0]));
    return n == Vec3{} ? kStockNormal : encode_normal(n);
  }

  /// Computes the length of the solid in each column.
  void measure_rows() {
    rows_.length.assign(starts_.size() - 1, 0);
    rows_.simple.assign(starts_.size() - 1, 1);
    for (std::size_t n = 0; n < rows_.length.size(); ++n) {
      if (starts_[n] == starts_[n + 1]) continue;
      read_column(n);
      for (const Dexel& d : elements_) rows_.length[n] += d.top - d.bottom;
      rows_.simple[n] = most_winding_ <= 1 ? 1 : 0;
    }
  }

  /// Computes the elements of a column, and the normal codes of their ends, from its hits.
  void read_column(std::size_t column) {
    elements_.clear();
    codes_.clear();
    most_winding_ = 0;
    std::int32_t winding = 0;
    for (std::size_t n = starts_[column]; n < starts_[column + 1];) {
      const Hit& hit = hits_[n];
      const std::int32_t before = winding;
      for (; n < starts_[column + 1] && hits_[n].depth == hit.depth; ++n) {
        winding += hits_[n].winding;
      }
      most_winding_ = std::max(most_winding_, std::abs(winding));
      if (before == 0 && winding != 0) {
        elements_.push_back({hit.depth, hit.depth});
        codes_.push_back({outward(hit.code, false), kStockNormal});
      } else if (before != 0 && winding == 0) {
        elements_.back().top = hit.depth;
        codes_.back().top = outward(hit.code, true);
      }
    }
  }

  /// Flips the normal of a mesh that is inside out.
  static NormalCode outward(NormalCode code, bool top) {
    if (code == kStockNormal) return code;
    const Vec3 n = decode_normal(code);
    return (n.z > 0) == top ? code : encode_normal(-n);
  }

  /// Returns null for a tile that is solid throughout, which the bounding box already represents.
  std::shared_ptr<DexelTile> make_tile(TileIndex at) {
    auto tile = std::make_shared<DexelTile>();
    tile->bottom.fill(0);
    tile->top.fill(0);
    if (keep_normals_) tile->topmost_codes.resize(kTileColumns);
    bool whole = true;
    for (int column = 0; column < kTileColumns; ++column) {
      const std::int32_t i = at.x * kTileSide + column % kTileSide;
      const std::int32_t row = column / kTileSide;
      if (i >= grid_.columns_x || at.y * kTileSide + row >= grid_.columns_y) continue;
      read_column(std::size_t(row + kMargin) * std::size_t(grid_.columns_x) + std::size_t(i));
      whole = whole && elements_.size() == 1 && elements_[0] == Dexel{0, grid_.height_quanta};
      if (!elements_.empty()) put_column(*tile, column);
    }
    if (whole) return nullptr;
    tile->update_bounds();
    return tile;
  }

  void put_column(DexelTile& tile, int column) const {
    tile.write(column, elements_);
    if (!keep_normals_) return;
    tile.topmost_codes[std::size_t(column)] = codes_.back();
    for (std::size_t n = 0; n + 1 < elements_.size(); ++n) {
      if (auto* code = tile.lower_bottom_code(column, elements_[n].bottom))
        *code = codes_[n].bottom;
      if (auto* code = tile.lower_top_code(column, elements_[n].top)) *code = codes_[n].top;
    }
  }

  const TriangleMesh& mesh_;
  const DexelGrid& grid_;
  const bool keep_normals_;
  std::vector<std::vector<std::uint32_t>> bands_;  ///< triangles that may cross each row of tiles
  std::vector<Hit> hits_;
  std::vector<std::size_t> starts_;  ///< first hit of each column
  std::vector<Dexel> elements_;
  std::vector<EndCodes> codes_;
  std::int32_t most_winding_ = 0;  ///< greatest in the column
  RowsOfMesh rows_;
};

struct Edge {
  std::uint32_t low, high;  ///< numbers of its vertices, low <= high
};

/// The sides of all triangles, ordered by the lower of their two vertices without a comparison of
/// all: a mesh may have millions.
class SidesByVertex {
 public:
  explicit SidesByVertex(const TriangleMesh& mesh) : begin_(mesh.vertices_mm.size() + 1, 0) {
    const auto each = [&mesh](auto&& visit) {
      for (const auto& t : mesh.triangles) {
        for (std::size_t c = 0; c < 3; ++c) {
          const std::uint32_t a = t[c], b = t[(c + 1) % 3];
          visit(std::min(a, b), Side{std::max(a, b), a < b});
        }
      }
    };
    each([this](std::uint32_t low, Side) { ++begin_[low + 1]; });
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    sides_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    each([&](std::uint32_t low, Side side) { sides_[next[low]++] = side; });
    for (std::size_t low = 0; low + 1 < begin_.size(); ++low)
      std::sort(sides_.begin() + std::ptrdiff_t(begin_[low]),
                sides_.begin() + std::ptrdiff_t(begin_[low + 1]),
                [](const Side& a, const Side& b) { return a.high < b.high; });
  }

  /// Calls visit(edge, number of its sides, number of those that lead to `high`), in the order of
  /// the vertices.
  template <class Visit>
  void for_each_edge(Visit&& visit) const {
    for (std::size_t low = 0; low + 1 < begin_.size(); ++low) {
      for (std::size_t first = begin_[low]; first < begin_[low + 1];) {
        std::size_t end = first, up = 0;
        for (; end < begin_[low + 1] && sides_[end].high == sides_[first].high; ++end)
          up += sides_[end].is_up ? 1 : 0;
        visit(Edge{std::uint32_t(low), sides_[first].high}, end - first, up);
        first = end;
      }
    }
  }

 private:
  struct Side {
    std::uint32_t high;
    bool is_up;  ///< the triangle goes from the lower vertex to the higher one
  };
  std::vector<Side> sides_;
  std::vector<std::size_t> begin_;  ///< first side of each lower vertex, and the end
};

std::string place_text(Vec3 p) {
  return std::to_string(p.x) + ", " + std::to_string(p.y) + ", " + std::to_string(p.z);
}

}  // namespace

BoxStock mesh_bounds(const TriangleMesh& mesh) {
  BoxStock box{mesh.vertices_mm.front(), mesh.vertices_mm.front()};
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t n : t) {
      const Vec3& v = mesh.vertices_mm[n];
      box.min_mm = {std::min(box.min_mm.x, v.x), std::min(box.min_mm.y, v.y),
                    std::min(box.min_mm.z, v.z)};
      box.max_mm = {std::max(box.max_mm.x, v.x), std::max(box.max_mm.y, v.y),
                    std::max(box.max_mm.z, v.z)};
    }
  }
  return box;
}

std::string mesh_stock_fault(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return "the mesh has no triangle";
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t n : t) {
      if (n >= mesh.vertices_mm.size())
        return "a triangle refers to a vertex that the mesh does not have";
      if (!is_finite(mesh.vertices_mm[n])) return "a vertex of the mesh is not finite";
    }
  }
  const SidesByVertex sides(mesh);
  std::size_t open = 0, turned = 0;
  std::optional<Edge> first_fault;
  sides.for_each_edge([&](Edge edge, std::size_t uses, std::size_t up) {
    if (2 * up == uses) return;
    if (!first_fault) first_fault = edge;
    ++(uses % 2 == 0 ? turned : open);
  });
  if (!first_fault) return {};
  return "the mesh is not closed: " + std::to_string(open) + " open edges, " +
         std::to_string(turned) +
         " edges between triangles of opposite orientation; the first from (" +
         place_text(mesh.vertices_mm[first_fault->low]) + ") to (" +
         place_text(mesh.vertices_mm[first_fault->high]) + ")";
}

void dexelize(const TriangleMesh& mesh, const DexelGrid& grid, bool keep_normals,
              const std::function<void(TileIndex, std::shared_ptr<DexelTile>)>& put,
              ColumnShares* shares, const StopAsked& stop_asked) {
  Dexelizer dexelizer(mesh, grid, keep_normals);
  std::map<TileIndex, ColumnShares::OfTile> near_walls;
  for (std::int32_t band = 0; band < grid.tiles_y(); ++band) {
    if (stop_asked && stop_asked()) break;
    dexelizer.run(band, put);
    if (shares != nullptr) dexelizer.add_shares(band, *shares, near_walls);
  }
  if (shares != nullptr) shares->set_tiles(std::move(near_walls));
}

}  // namespace kerf
