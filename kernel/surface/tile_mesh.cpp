// SPDX-License-Identifier: Apache-2.0
#include "kernel/surface/tile_mesh.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <optional>

#include "kernel/surface/column_window.h"
#include "kernel/surface/face_vertex.h"
#include "kernel/surface/flat_quads.h"
#include "kernel/surface/lattice_cells.h"
#include "kernel/surface/open_patches.h"
#include "kernel/surface/quad_shape.h"
#include "kernel/surface/quad_split.h"
#include "kernel/surface/scratch.h"
#include "kernel/surface/vertex_placement.h"

namespace kerf {
namespace {

constexpr std::uint32_t kNoVertex = std::numeric_limits<std::uint32_t>::max();

/// A tile reads the columns up to this many beyond its own (window_), which are those of its
/// neighbors only.
constexpr std::int32_t kReach = kGuessMargin + 1;
static_assert(kReach <= kTileSide);

/// One of the four cells around a crossed lattice edge.
struct Corner {
  std::size_t position = 0;  ///< in LatticeCells
  std::int32_t x = 0, y = 0;
  unsigned edge = 0;  ///< number of the crossed edge in this cell
};
using Corners = std::array<Corner, 4>;

/// Flag of a cell's vertex entry. The other bits are an index into the split vertices.
constexpr std::uint32_t kSplit = std::uint32_t{1} << 31;

/// A vertex that may appear several times in the mesh, with different normals.
struct SplitVertex {
  SurfaceVertex vertex;
  std::array<std::uint32_t, kVertexNormalsMax> index;  ///< by group of edges
};

/// Builds one tile's mesh: a quadrangle for each crossed lattice edge that the tile owns. A
/// vertical edge belongs to the tile of its column, a horizontal edge to the tile of its lower
/// column, or of the only column that is in the grid.
class TileMesher {
 public:
  /// `cover` may be null, so that nothing is left out.
  TileMesher(const SolidSnapshot& solid, TileIndex tile, const FaceCover* cover)
      : tile_(tile),
        open_(cover, solid.grid(), tile),
        first_x_(tile.x * kTileSide),
        first_y_(tile.y * kTileSide),
        end_x_(std::min(first_x_ + kTileSide, solid.fields.front().grid().columns_x)),
        end_y_(std::min(first_y_ + kTileSide, solid.fields.front().grid().columns_y)),
        window_(solid, first_x_ - kReach, first_y_ - kReach, kTileSide + 2 * kReach),
        cells_(window_, first_x_ - 1, first_y_ - 1, kTileSide + 1, open_.next_layer()),
        placement_(solid, window_),
        bends_(window_, cells_, placement_),
        vertex_(cells_.size(), kNoVertex) {}

  TileMesh run() {
    for (std::int32_t j = first_y_; j < end_y_; ++j) {
      for (std::int32_t i = first_x_; i < end_x_; ++i) add_ends(i, j);
    }
    for (std::int32_t j = first_y_; j < end_y_; ++j) {
      for (std::int32_t i = first_x_ == 0 ? -1 : first_x_; i < end_x_; ++i) add_sides(i, j, true);
    }
    for (std::int32_t j = first_y_ == 0 ? -1 : first_y_; j < end_y_; ++j) {
      for (std::int32_t i = first_x_; i < end_x_; ++i) add_sides(i, j, false);
    }
    if (flat_.append_triangles(*positions_, *indices_)) drop_unused_vertices();
    // Copied to the exact size.
    TileMesh mesh;
    mesh.tile = tile_;
    mesh.positions_mm.assign(positions_->begin(), positions_->end());
    mesh.normals.assign(normals_->begin(), normals_->end());
    mesh.indices.assign(indices_->begin(), indices_->end());
    mesh.original.assign(original_->begin(), original_->end());
    return mesh;
  }

 private:
  /// Adds the quadrangles across the ends of a column's runs.
  void add_ends(std::int32_t i, std::int32_t j) {
    for (const SolidRun& run : window_.runs(i, j)) {
      if (open_.has_bottom(run.first)) {
        add_quad(around_upright(i, j, run.first), {2, true, run.bottom}, i, j,
                 {i, j, run.first - 1, 2});
      }
      if (open_.has_top(run.end)) {
        add_quad(around_upright(i, j, run.end), {2, false, run.top}, i, j, {i, j, run.end - 1, 2});
      }
    }
  }

  Corners around_upright(std::int32_t i, std::int32_t j, std::int32_t layer) const {
    return {Corner{cells_.find(i - 1, j - 1, layer), i - 1, j - 1, 11},
            Corner{cells_.find(i, j - 1, layer), i, j - 1, 10},
            Corner{cells_.find(i, j, layer), i, j, 8},
            Corner{cells_.find(i - 1, j, layer), i - 1, j, 9}};
  }

  /// Adds the quadrangles between column (i, j) and its next neighbor, at the samples where exactly
  /// one of them is solid.
  void add_sides(std::int32_t i, std::int32_t j, bool along_x) {
    const auto a = window_.runs(i, j);
    const auto b = along_x ? window_.runs(i + 1, j) : window_.runs(i, j + 1);
    std::size_t na = 0, nb = 0;  // changes passed, two per run
    const auto change = [](std::span<const SolidRun> runs, std::size_t n) {
      if (n / 2 >= runs.size()) return std::numeric_limits<std::int32_t>::max();
      return n % 2 == 0 ? runs[n / 2].first : runs[n / 2].end;
    };
    while (na < 2 * a.size() || nb < 2 * b.size()) {
      const std::int32_t first = std::min(change(a, na), change(b, nb));
      if (change(a, na) == first) ++na;
      if (change(b, nb) == first) ++nb;
      if (na % 2 == nb % 2) continue;
      const std::int32_t end = std::min(change(a, na), change(b, nb));
      const bool reversed = na % 2 == 0;
      const std::optional<StockFace> side = open_.side_between(i, j, along_x);
      for (auto open = open_.next(side, first, end); open.first < open.end;
           open = open_.next(side, open.end, end)) {
        add_wall(i, j, along_x, open.first, open.end, reversed);
      }
    }
  }

  /// Adds the quadrangles of samples [first, end), where the columns differ. `reversed` states that
  /// the lower one is empty.
  void add_wall(std::int32_t i, std::int32_t j, bool along_x, std::int32_t first, std::int32_t end,
                bool reversed) {
    // Cells before and behind the edge, ordered so that (before, behind, up) is right-handed about
    // the edge.
    const std::int32_t before_x = i;
    const std::int32_t before_y = along_x ? j - 1 : j;
    const std::int32_t behind_x = along_x ? i : i - 1;
    const std::int32_t behind_y = j;
    const unsigned edge_before = along_x ? 1 : 4;
    const unsigned edge_behind = along_x ? 0 : 5;
    std::size_t before = cells_.find(before_x, before_y, first);
    std::size_t behind = cells_.find(behind_x, behind_y, first);
    const FlatPlane plane{static_cast<std::uint8_t>(along_x ? 0 : 1), reversed, along_x ? i : j};
    const std::int32_t u = along_x ? j : -i;  // grows from before to behind
    for (std::int32_t sample = first; sample < end; ++sample, ++before, ++behind) {
      add_quad({Corner{before, before_x, before_y, edge_before + 2},
                Corner{behind, behind_x, behind_y, edge_behind + 2},
                Corner{behind + 1, behind_x, behind_y, edge_behind},
                Corner{before + 1, before_x, before_y, edge_before}},
               plane, u, sample, {i, j, sample, plane.axis});
    }
  }

  /// Adds the quadrangle at (u, v) of the plane: as triangles within the envelope of its edge or,
  /// if it is flat, to the mergeable ones.
  void add_quad(const Corners& corners, const FlatPlane& plane, std::int32_t u, std::int32_t v,
                const LatticeEdge& edge) {
    QuadCorners c{};
    bool several_sheets = false;
    for (std::size_t n = 0; n < 4; ++n) c[n] = vertex_of(corners[n], several_sheets);
    // Before flat quadrangles are merged, because the two quadrangles at a segment must bend it
    // alike.
    if (several_sheets && add_bent(corners, c, plane.reversed, edge)) return;
    const bool flat = is_flat(*positions_, *normals_, c, plane.axis);
    if (flat && is_rectangle(*positions_, c, plane.axis)) {
      flat_.add(plane, u, v, c, QuadSplit::kFirst);
      return;
    }
    const QuadSplit split = split_of(c, plane.reversed, flat, edge);
    if (split == QuadSplit::kFan) {
      add_fan(c, {}, plane.reversed, edge);
      return;
    }
    if (flat) {
      flat_.add(plane, u, v, c, split);
      return;
    }
    if (plane.reversed) std::swap(c[1], c[3]);
    if (split == QuadSplit::kSecond) c = {c[1], c[2], c[3], c[0]};
    indices_->insert(indices_->end(), {c[0], c[1], c[2], c[0], c[2], c[3]});
  }

  /// Adds a quadrangle with vertices between its corners. Returns false if it has none.
  bool add_bent(const Corners& corners, const QuadCorners& c, bool reversed,
                const LatticeEdge& edge) {
    std::array<std::size_t, 4> cells{};
    for (std::size_t n = 0; n < 4; ++n) cells[n] = corners[n].position;
    FaceVertices::OfQuad between;
    if (!bends_.find(edge, cells, positions_of(c), between)) return false;
    add_fan(c, between, reversed, edge);
    return true;
  }

  FaceVertices::Corners positions_of(const QuadCorners& c) const {
    return {(*positions_)[c[0]], (*positions_)[c[1]], (*positions_)[c[2]], (*positions_)[c[3]]};
  }

  QuadSplit split_of(const QuadCorners& c, bool reversed, bool flat,
                     const LatticeEdge& edge) const {
    QuadShape shape;
    std::array<Vec3, 4> beside;
    for (std::size_t n = 0; n < 4; ++n) {
      shape.positions_mm[n] = (*positions_)[c[n]];
      shape.normals[n] = (*normals_)[c[n]];
      shape.sharp |= sharp_[c[n]];
      beside[n] = placement_.beside_edge(edge, shape.positions_mm[n]);
    }
    const bool second = !flat && prefers_other_diagonal(shape, reversed);
    return split_within_envelope(beside, flat, second ? QuadSplit::kSecond : QuadSplit::kFirst);
  }

  /// Adds a quadrangle as a fan about a vertex on its edge.
  void add_fan(const QuadCorners& c, const FaceVertices::OfQuad& between, bool reversed,
               const LatticeEdge& edge) {
    std::array<std::uint32_t, 8> rim{};
    std::size_t count = 0;
    for (std::size_t n = 0; n < 4; ++n) {
      rim[count++] = c[n];
      if (between[n]) rim[count++] = add_vertex(*between[n], 0);
    }
    const std::uint32_t center = add_vertex(placement_.place_center(edge, positions_of(c)), 0);
    for (std::size_t n = 0; n < count; ++n) {
      const std::uint32_t a = rim[n], b = rim[(n + 1) % count];
      indices_->insert(indices_->end(), {center, reversed ? b : a, reversed ? a : b});
    }
  }

  void drop_unused_vertices() {
    std::vector<std::uint32_t> renumbered(positions_->size(), kNoVertex);
    std::uint32_t kept = 0;
    for (const std::uint32_t index : *indices_) renumbered[index] = 0;
    for (std::size_t v = 0; v < renumbered.size(); ++v) {
      if (renumbered[v] == kNoVertex) continue;
      (*positions_)[kept] = (*positions_)[v];
      (*normals_)[kept] = (*normals_)[v];
      (*original_)[kept] = (*original_)[v];
      renumbered[v] = kept++;
    }
    positions_->resize(kept);
    normals_->resize(kept);
    original_->resize(kept);
    for (std::uint32_t& index : *indices_) index = renumbered[index];
  }

  /// Returns the mesh vertex of a cell for an edge, and creates it on first use, so that the mesh
  /// contains no unused vertex. Sets `several_sheets` if the cell has more than one sheet.
  std::uint32_t vertex_of(const Corner& corner, bool& several_sheets) {
    std::uint32_t& entry = vertex_[corner.position];
    if (entry < kSplit) return entry;
    const CellSheets& sheets = cells_.sheets(corner.position);
    if (entry == kNoVertex) {
      for (std::uint8_t sheet = 0; sheet < sheets.count; ++sheet) {
        const SurfaceVertex vertex = placement_.place(cell_of(corner), sheets, sheet);
        if (sheets.count == 1 && vertex.normal_count == 1) return entry = add_vertex(vertex, 0);
        split_.push_back({vertex, {kNoVertex, kNoVertex, kNoVertex}});
      }
      entry = kSplit | static_cast<std::uint32_t>(split_.size() - sheets.count);
    }
    several_sheets |= sheets.count > 1;
    const std::uint8_t sheet = sheets.of_edge[corner.edge];
    assert(sheet != kNoSheet);
    SplitVertex& split = split_[(entry & ~kSplit) + sheet];
    const std::size_t group = split.vertex.group_of_edge[corner.edge];
    if (split.index[group] == kNoVertex) split.index[group] = add_vertex(split.vertex, group);
    return split.index[group];
  }

  LatticeCell cell_of(const Corner& corner) const {
    return cells_.cell(corner.position, corner.x, corner.y);
  }

  std::uint32_t add_vertex(const SurfaceVertex& vertex, std::size_t group) {
    positions_->push_back(vertex.position_mm);
    normals_->push_back(vertex.normals[group]);
    original_->push_back(vertex.original[group] ? 1 : 0);
    sharp_.push_back(vertex.sharp);
    return static_cast<std::uint32_t>(positions_->size() - 1);
  }

  TileIndex tile_;
  OpenPatches open_;
  std::int32_t first_x_, first_y_, end_x_, end_y_;
  ColumnWindow window_;
  LatticeCells cells_;
  VertexPlacement placement_;
  FaceVertices bends_;
  std::vector<std::uint32_t> vertex_;  ///< per cell: its vertex, or kSplit | its index in split_
  std::vector<SplitVertex> split_;     ///< of cells with several sheets or a crease
  std::vector<bool> sharp_;            ///< per mesh vertex, whether it is on a crease
  FlatQuads flat_;
  /// Buffers of the mesh.
  Scratch<std::array<float, 3>, 0> positions_;
  Scratch<std::array<float, 3>, 1> normals_;
  Scratch<std::uint32_t> indices_;
  Scratch<std::uint8_t> original_;
};

}  // namespace

TileMesh mesh_tile(const SolidSnapshot& solid, TileIndex tile) {
  return TileMesher(solid, tile, nullptr).run();
}

TileMesh mesh_tile(const SolidSnapshot& solid, TileIndex tile, const FaceCover& cover) {
  return TileMesher(solid, tile, &cover).run();
}

std::vector<TileIndex> tiles_that_read(const DexelGrid& grid,
                                       std::span<const ChangedColumns> changed) {
  const auto before = [](std::int32_t begin) { return begin < kReach ? 1 : 0; };
  const auto after = [](std::int32_t end) { return end > kTileSide - kReach ? 1 : 0; };
  std::vector<TileIndex> tiles;
  for (const ChangedColumns& at : changed) {
    const std::int32_t last_x = std::min(at.tile.x + after(at.end_x), grid.tiles_x() - 1);
    const std::int32_t last_y = std::min(at.tile.y + after(at.end_y), grid.tiles_y() - 1);
    for (std::int32_t y = std::max(at.tile.y - before(at.begin_y), 0); y <= last_y; ++y) {
      for (std::int32_t x = std::max(at.tile.x - before(at.begin_x), 0); x <= last_x; ++x) {
        tiles.push_back({x, y});
      }
    }
  }
  std::sort(tiles.begin(), tiles.end());
  tiles.erase(std::unique(tiles.begin(), tiles.end()), tiles.end());
  return tiles;
}

std::vector<TileIndex> tiles_to_remesh(const DexelGrid& grid,
                                       const std::vector<TileIndex>& changed) {
  std::vector<ChangedColumns> columns;
  columns.reserve(changed.size());
  for (const TileIndex tile : changed) columns.push_back({tile});
  return tiles_that_read(grid, columns);
}

}  // namespace kerf
