// SPDX-License-Identifier: Apache-2.0
#pragma once

// Settings of a Sculpture and the limits that Sculpture::create enforces on them.

#include <cstdint>
#include <memory>
#include <vector>

#include "kernel/dexel/stock_shape.h"
#include "kernel/dexel/triangle_mesh.h"
#include "kernel/force/force_settings.h"
#include "kernel/force/obstacle.h"
#include "kernel/sweep/motion_kind.h"

namespace kerf {

/// Directions of the rays that sample the stock. kDexel: one field of rays along Z, as in the
/// paper. It is cheapest, but locates walls parallel to Z only to the pitch. kTriDexel: three
/// fields, along Z, X and Y. At least one of them locates every surface exactly, at 2.5 to 10 times
/// the cost (kernel/cut/README.md, "Speed").
enum class Rays : std::uint8_t { kDexel, kTriDexel };

/// Returns "dexel" or "tri-dexel", the names used in scenes and on the command line.
const char* to_string(Rays rays);

/// Everything that defines a block before it is first cut. Lengths in mm.
struct SculptureSettings {
  /// The initial solid, ignored if stock_mesh is set. Sides >= kStockSizeMinMm, coordinates within
  /// ±kCoordinateMaxMm.
  StockShape stock;
  /// The initial solid as a closed mesh, or null (kernel/dexel/mesh_stock.h). `create` reads it and
  /// drops the pointer; settings().stock is then its bounding box.
  std::shared_ptr<const TriangleMesh> stock_mesh;
  Rays rays = Rays::kDexel;
  /// Distance of neighboring rays, in [0.0001, 1000]. A field may have at most kColumnsMax columns,
  /// or kMeshColumnsMax if the stock is a mesh. With keep_normals, no side of the stock may be
  /// longer than kSurfacePitchesMax pitches.
  double pitch_mm = 0.25;
  /// Greatest distance of a dexel's end from the swept surface, for both motion models, in
  /// [0.000001, 100].
  double tolerance_mm = 0.01;
  MotionModel motion = MotionModel::kTight;
  /// Stores a surface normal with every end of every dexel, which mesh_tile (kernel/surface) needs.
  /// Doubles the memory of the dexels and costs time for every end that a motion moves.
  bool keep_normals = true;
  ForceSettings force;
  std::vector<Obstacle> obstacles;
};

/// Greatest absolute value of a coordinate of the stock or of a tool tip, in mm.
inline constexpr double kCoordinateMaxMm = 1e6;
/// Shortest permitted side of the stock, in mm.
inline constexpr double kStockSizeMinMm = 0.0001;
/// Greatest number of columns of one field.
inline constexpr std::int64_t kColumnsMax = std::int64_t{1} << 36;
/// Greatest number of columns of one field whose stock is a mesh. It is lower because nearly all
/// tiles of such a field are stored from the beginning.
inline constexpr std::int64_t kMeshColumnsMax = std::int64_t{1} << 28;
/// Longest permitted side of a stock whose surface is meshed, in pitches. The positions of vertices
/// are floats, which do not distinguish neighboring columns beyond it.
inline constexpr std::int64_t kSurfacePitchesMax = std::int64_t{1} << 20;

}  // namespace kerf
