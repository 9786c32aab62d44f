// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kernel/dexel/solid_snapshot.h"
#include "server/carve/deviation.h"
#include "server/formats/model/model_writer.h"
#include "server/formats/model/simplify_mesh.h"

namespace kerf {

/// One model file that the command line asks for.
struct ModelChoice {
  ModelFormat format = ModelFormat::kStl;
  std::filesystem::path path;
  ModelEncoding encoding = ModelEncoding::kBinary;
};

/// What is to be done with the surface before it is written.
struct SurfaceRequest {
  SimplifyRequest simplify;                        ///< neither: the surface as it is
  std::optional<std::filesystem::path> reference;  ///< measure the deviation from this mesh
  std::optional<double> range_mm;  ///< where the colours end; otherwise the 99th percentile
};

/// What was done with it, for the report.
struct SurfaceReport {
  std::optional<std::uint64_t> exact_triangles;  ///< before it was simplified
  std::optional<double> simplify_error_mm;
  std::optional<DistanceFigures> deviation;
  double range_mm = 0;  ///< of the colours
};

/// The mesh to measure against. The error is one line.
std::expected<IndexedMesh, std::string> load_reference(const std::filesystem::path& file);

/// The surface of a carved block, made ready to be written any number of times, side by side.
class CarvedSurface {
 public:
  /// `reference` may be null. The error is one sentence.
  static std::expected<std::unique_ptr<CarvedSurface>, std::string> make(
      const SolidSnapshot& snapshot, const SurfaceRequest& request, const IndexedMesh* reference,
      const ModelProgress& progress);

  const SurfaceReport& report() const { return report_; }
  /// Writes it; the number of triangles in the file. The error is one sentence.
  std::expected<std::uint64_t, std::string> write(const ModelChoice& choice,
                                                  const std::filesystem::path& path,
                                                  const std::string& title,
                                                  const ModelProgress& progress) const;

 private:
  explicit CarvedSurface(const SolidSnapshot& snapshot) : snapshot_(snapshot) {}
  std::unique_ptr<MeshSource> plain() const;

  SolidSnapshot snapshot_;
  std::optional<IndexedMesh> simplified_;
  std::optional<Deviation> deviation_;
  SurfaceReport report_;
};

}  // namespace kerf
