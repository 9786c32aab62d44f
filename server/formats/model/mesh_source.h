// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "kernel/cut/workers.h"
#include "kernel/dexel/solid_snapshot.h"
#include "kernel/math/vec3.h"
#include "kernel/surface/solid_surface.h"

namespace kerf {

/// A part of a surface that fits into memory. Adjacent parts have bit-identical positions on their
/// common border.
struct MeshPiece {
  std::vector<std::array<float, 3>> positions_mm;   ///< relative to MeshSource::origin_mm
  std::vector<std::array<float, 3>> normals;        ///< unit, outward; one per position
  std::vector<std::array<std::uint8_t, 3>> colors;  ///< sRGB; one per position, or empty
  std::vector<float> deviations_mm;                 ///< one per position, or empty
  std::vector<std::uint32_t> indices;  ///< three per triangle, counter-clockwise seen from outside
};

/// A closed surface, read piece by piece so that writers do not hold all of it in memory.
class MeshSource {
 public:
  virtual ~MeshSource() = default;
  /// Returns the scene coordinates of position (0, 0, 0), mm.
  virtual Vec3 origin_mm() const = 0;
  /// Returns the upper bounds of all positions, relative to the origin. The lower bounds are >= 0.
  virtual Vec3 size_mm() const = 0;
  /// Replaces `piece` by the next one, which may have no triangles. Returns false at the end.
  virtual bool next(MeshPiece& piece) = 0;
  /// Returns the fraction that has been read, 0 to 1.
  virtual double share() const = 0;
};

/// Detail of the stock's flat faces where they are untouched. kMerged: squares that grow with the
/// distance from cuts, so that the size depends on the carved area. kByTile: the mesh of each tile,
/// for values that vary along a face.
enum class FlatFaces : std::uint8_t { kMerged, kByTile };

/// The surface of a snapshot, meshed piece by piece on demand; with `workers`, which must outlive
/// it, some pieces ahead on several threads. The pieces do not depend on them.
class SnapshotMesh final : public MeshSource {
 public:
  explicit SnapshotMesh(SolidSnapshot snapshot, FlatFaces faces = FlatFaces::kMerged,
                        Workers* workers = nullptr)
      : snapshot_(std::move(snapshot)), faces_(faces), workers_(workers) {}
  Vec3 origin_mm() const override { return snapshot_.grid().origin_mm; }
  Vec3 size_mm() const override;
  bool next(MeshPiece& piece) override;
  double share() const override;

 private:
  bool begin(TileMesh& mesh);
  void finish(TileMesh& mesh) const;
  void mesh_ahead();

  SolidSnapshot snapshot_;
  FlatFaces faces_;
  Workers* workers_;
  std::unique_ptr<SolidSurface> merged_;  ///< made by the first next() if faces are merged
  std::vector<TileMesh> ahead_;           ///< meshed at the same time
  std::size_t read_ = 0;                  ///< of these
  std::int64_t next_tile_ = 0;
};

}  // namespace kerf
