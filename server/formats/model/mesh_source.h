// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernel/dexel/solid_snapshot.h"
#include "kernel/math/vec3.h"

namespace kerf {

/// A part of a surface that fits into memory. Parts of one surface meet in positions of equal bits.
struct MeshPiece {
  std::vector<std::array<float, 3>> positions_mm;   ///< relative to MeshSource::origin_mm
  std::vector<std::array<float, 3>> normals;        ///< unit, outward; one per position
  std::vector<std::array<std::uint8_t, 3>> colors;  ///< sRGB; one per position, or none at all
  std::vector<float> deviations_mm;                 ///< one per position, or none at all
  std::vector<std::uint32_t> indices;  ///< three per triangle, counter-clockwise seen from outside
};

/// A closed surface, handed out piece by piece, so that writing it needs no memory for the whole.
class MeshSource {
 public:
  virtual ~MeshSource() = default;
  /// Where position (0, 0, 0) lies in the scene, mm.
  virtual Vec3 origin_mm() const = 0;
  /// Bounds of the surface, relative to the origin; no position lies outside.
  virtual Vec3 size_mm() const = 0;
  /// Replaces `piece` by the next one, which may have no triangle. False at the end.
  virtual bool next(MeshPiece& piece) = 0;
  /// How much has been handed out, 0 to 1.
  virtual double share() const = 0;
};

/// The surface of a snapshot, meshed tile by tile as it is asked for.
class SnapshotMesh final : public MeshSource {
 public:
  explicit SnapshotMesh(SolidSnapshot snapshot) : snapshot_(std::move(snapshot)) {}
  Vec3 origin_mm() const override { return snapshot_.grid().origin_mm; }
  Vec3 size_mm() const override;
  bool next(MeshPiece& piece) override;
  double share() const override;

 private:
  SolidSnapshot snapshot_;
  std::int64_t next_tile_ = 0;
};

}  // namespace kerf
