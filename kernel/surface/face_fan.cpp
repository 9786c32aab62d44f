// SPDX-License-Identifier: Apache-2.0
#include "kernel/surface/face_fan.h"

#include <algorithm>
#include <cassert>

#include "kernel/surface/column_window.h"
#include "kernel/surface/lattice_cells.h"
#include "kernel/surface/level_guess.h"
#include "kernel/surface/vertex_placement.h"

namespace kerf {
namespace {

/// Returns the cell of vertex (a, b, c) of the lattice: between columns a - 1 and a, b - 1 and b,
/// and samples c - 1 and c.
LatticeCell cell_of(const LatticePoint& vertex) {
  return {vertex[0] - 1, vertex[1] - 1, vertex[2]};
}

std::array<float, 3> place(const SolidSnapshot& solid, const LatticePoint& vertex) {
  const LatticeCell cell = cell_of(vertex);
  const ColumnWindow window(solid, cell.x - kGuessMargin, cell.y - kGuessMargin,
                            2 + 2 * kGuessMargin);
  const CellSheets& sheets = sheets_of(cell_configuration(window, cell));
  assert(sheets.count == 1);
  return VertexPlacement(solid, window).place(cell, sheets, 0).position_mm;
}

}  // namespace

FaceFan::FaceFan(const SolidSnapshot& solid, const FaceCover& cover)
    : solid_(solid), cover_(cover), low_z_(ColumnWindow(solid, 0, 0, 1).level_zero() - 0.5) {}

/// Appends the vertices on one side of a square to the rim, without the last one. `along` is the
/// axis of the side, and `high` selects one of its two sides.
void FaceFan::append_side(const FaceRange& square, std::size_t along, bool high, bool backwards) {
  const StockFace face = square.face;
  const std::size_t across = along == face.u_axis() ? face.v_axis() : face.u_axis();
  const LatticePoint& quads = cover_.quads();
  LatticePoint vertex{};
  vertex[face.axis] = face.high ? quads[face.axis] : 0;
  vertex[across] = high ? square.high[across] : square.low[across];
  // The patches beyond the side, on the same face or on the adjacent one.
  StockFace beyond = face;
  LatticePoint patch{};
  if (vertex[across] == 0 || vertex[across] == quads[across]) {
    beyond = {static_cast<std::uint8_t>(across), high};
    patch[face.axis] = face.high ? cover_.patches()[face.axis] - 1 : 0;
  } else {
    patch[across] = vertex[across] / kTileSide - (high ? 0 : 1);
  }
  const std::size_t start = rim_.size();
  const std::int32_t end = square.high[along];
  for (std::int32_t at = square.low[along]; at < end;) {
    patch[along] = at / kTileSide;
    const int level = cover_.level_at(beyond, patch[beyond.u_axis()], patch[beyond.v_axis()]);
    const std::int32_t next =
        level < 0 ? at + 1 : (((patch[along] >> level) + 1) << level) * kTileSide;
    vertex[along] = at;
    rim_.push_back(vertex);
    at = next;
  }
  vertex[along] = end;
  if (!backwards) return;
  rim_.push_back(vertex);
  std::reverse(rim_.begin() + std::ptrdiff_t(start), rim_.end());
  rim_.pop_back();
}

void FaceFan::append(StockFace face, const FaceNode& node, TileMesh& mesh) {
  FaceRange square = node.range(face, cover_.patches());
  for (const std::size_t axis : {face.u_axis(), face.v_axis()}) {
    square.low[axis] *= kTileSide;
    square.high[axis] = std::min(square.high[axis] * kTileSide, cover_.quads()[axis]);
  }
  rim_.clear();
  append_side(square, face.u_axis(), false, false);
  append_side(square, face.v_axis(), true, false);
  append_side(square, face.u_axis(), true, true);
  append_side(square, face.v_axis(), false, true);
  const auto first = static_cast<std::uint32_t>(mesh.positions_mm.size());
  const auto corners = static_cast<std::uint32_t>(rim_.size());
  for (const LatticePoint& vertex : rim_) mesh.positions_mm.push_back(position(vertex));
  const auto triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (!face.high) std::swap(b, c);
    mesh.indices.insert(mesh.indices.end(), {first + a, first + b, first + c});
  };
  if (corners == 4) {
    triangle(0, 1, 2);
    triangle(0, 2, 3);
  } else {
    const std::size_t u = face.u_axis(), v = face.v_axis();
    Position center = mesh.positions_mm[first];
    const auto opposite = std::ranges::find_if(rim_, [&](const LatticePoint& p) {
      return p[u] == square.high[u] && p[v] == square.high[v];
    });
    const Position far = position(*opposite);
    for (const std::size_t axis : {u, v}) {
      center[axis] = static_cast<float>(0.5 * (double(center[axis]) + double(far[axis])));
    }
    mesh.positions_mm.push_back(center);
    for (std::uint32_t n = 0; n < corners; ++n) triangle(corners, n, (n + 1) % corners);
  }
  std::array<float, 3> normal{};
  normal[face.axis] = face.high ? 1.0F : -1.0F;
  mesh.normals.resize(mesh.positions_mm.size(), normal);
  mesh.original.resize(mesh.positions_mm.size(), 1);
}

FaceFan::Position FaceFan::position(const LatticePoint& vertex) {
  const LatticePoint& quads = cover_.quads();
  std::array<bool, 3> middle{};
  std::size_t kind = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    middle[axis] = vertex[axis] > 0 && vertex[axis] < quads[axis];
    kind = 3 * kind + (middle[axis] ? 1U : vertex[axis] == 0 ? 0U : 2U);
  }
  if (!placed_[kind]) placed_[kind] = place(solid_, vertex);
  Position p = *placed_[kind];
  const double pitch = solid_.grid().pitch_mm;
  if (middle[0]) p[0] = static_cast<float>(vertex[0] * pitch);
  if (middle[1]) p[1] = static_cast<float>(vertex[1] * pitch);
  if (middle[2]) p[2] = static_cast<float>((vertex[2] + low_z_) * pitch);
  return p;
}

}  // namespace kerf
