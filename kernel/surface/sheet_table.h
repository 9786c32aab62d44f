// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "kernel/math/vec3.h"

// Manifold dual contouring. Based on: G. Nielson, Dual Marching Cubes (2004), and R. Wenger,
// Isosurfaces (2013), chapter 3. A lattice cell has one vertex for each sheet of the surface that
// passes through it.
//
// Corner c of a cell is dx + 2 dy + 4 dz; a configuration has bit c set if that corner is solid.
// Edges: 0-3 along x (dy + 2 dz), 4-7 along y (4 + dx + 2 dz), 8-11 along z (8 + dx + 2 dy). Faces:
// 0 -x, 1 +x, 2 -y, 3 +y, 4 -z, 5 +z.

namespace kerf {

inline constexpr std::uint8_t kNoSheet = 0xff;
inline constexpr int kSheetsMax = 4;

/// The sheets of the surface in a cell of one configuration.
struct CellSheets {
  std::uint8_t count = 0;                         ///< sheets, 0 to 4
  std::array<std::uint8_t, 12> of_edge{};         ///< sheet that crosses the edge, or kNoSheet
  std::array<std::uint16_t, kSheetsMax> edges{};  ///< per sheet: bit e is set if it crosses edge e
  int doubled_face = -1;  ///< ambiguous face that one sheet crosses twice, or -1
};

/// Corners and edges of a face, in cyclic order; edge n joins corners n and n + 1.
struct CellFace {
  std::array<std::uint8_t, 4> corners, edges;
};
inline constexpr std::array<CellFace, 6> kCellFaces{{
    {{0, 2, 6, 4}, {4, 10, 6, 8}},
    {{1, 3, 7, 5}, {5, 11, 7, 9}},
    {{0, 1, 5, 4}, {0, 9, 2, 8}},
    {{2, 3, 7, 6}, {1, 11, 3, 10}},
    {{0, 1, 3, 2}, {0, 5, 1, 4}},
    {{4, 5, 7, 6}, {2, 7, 3, 6}},
}};

/// Returns the sheets of a configuration. On an ambiguous face (solid corners on one diagonal,
/// empty ones on the other) the solid corners are separated. Both cells at the face decide alike,
/// because the decision depends on the face only. If one sheet crosses that face twice in both
/// cells, the two quadrangles there would share an edge; both cells then use `flipped_sheets_of`,
/// which joins the solid corners.
const CellSheets& sheets_of(std::uint8_t configuration);
const CellSheets& flipped_sheets_of(std::uint8_t configuration);

/// Returns the point of the segment from `inside` to `place`, nearest to `place`, that is on a
/// sheet's own side of the planes that separate the lattice edges crossed by it from those crossed
/// by the other sheets of its cell. Triangles between such points and those edges do not meet other
/// sheets' triangles. Both points are in pitches from the cell's center; `inside` is on the sheet's
/// own side.
Vec3 on_own_side(const CellSheets& sheets, std::uint8_t sheet, Vec3 inside, Vec3 place);

}  // namespace kerf
