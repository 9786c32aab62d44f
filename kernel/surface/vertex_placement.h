#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "kernel/surface/column_window.h"
#include "kernel/surface/sheet_table.h"

namespace kerf {

/// A cell of the lattice: between columns (x, y) and (x + 1, y + 1), and between samples layer - 1
/// and layer.
struct LatticeCell {
  std::int32_t x = 0, y = 0, layer = 0;
};

/// A point of the mesh. Where a wall meets a floor or another wall, the faces on the sides of the
/// crease see different normals: one for the faces across lattice edges along each axis.
struct SurfaceVertex {
  std::array<float, 3> position_mm;               ///< relative to DexelGrid::origin_mm
  std::array<std::array<float, 3>, 3> normal_of;  ///< by axis of the crossed edge: x, y, z
  bool smooth() const { return normal_of[0] == normal_of[1] && normal_of[0] == normal_of[2]; }
};

/// Columns around a cell that decide its vertices: cells [first, end) need columns [first - 2, end
/// + 2].
inline constexpr std::int32_t kPlacementMargin = 2;

/// Decides where the vertices of the mesh lie and which way they look, from the columns near them
/// only, so that two tiles that compute the same vertex get the same bits.
class VertexPlacement {
 public:
  explicit VertexPlacement(const ColumnWindow& window);

  /// The vertex of the sheet that crosses these edges (bits as in CellSheets::edges) of the cell.
  SurfaceVertex place(const LatticeCell& cell, std::uint16_t edges);
  /// The same for a cell with several sheets: no two of its vertices coincide.
  SurfaceVertex place_sheet(const LatticeCell& cell, const CellSheets& sheets, std::uint8_t sheet);

 private:
  struct EndNormal {
    Vec3 normal;
    bool known = false;
  };
  struct Side;
  struct Sums;

  Vec3 end_normal(std::int32_t i, std::int32_t j, DexelEnd kind, std::size_t run);
  double end_slope(std::int32_t i, std::int32_t j, std::int32_t step_x, std::int32_t step_y,
                   DexelEnd kind, std::int32_t height) const;
  bool is_wall(std::int32_t i, std::int32_t j, std::int32_t step_x, std::int32_t step_y,
               DexelEnd kind, std::int32_t near, std::int32_t far) const;
  void fit_wall(Side& side, std::int32_t i, std::int32_t j, bool along_x, std::int32_t sample,
                bool reversed) const;
  int wall_offset(std::int32_t i, std::int32_t j, bool along_x, std::int32_t sample,
                  bool reversed) const;
  Side side_crossing(std::int32_t i, std::int32_t j, bool along_x, std::int32_t sample);
  void add_upright(Sums& sums, const LatticeCell& cell, int dx, int dy);
  void add_level(Sums& sums, const LatticeCell& cell, bool along_x, int across, int dz);

  const ColumnWindow& window_;
  const double steps_per_quantum_;  ///< heights in lattice steps
  std::vector<EndNormal> normals_;  ///< bottom and top of each run, filled as needed
};

}  // namespace kerf
