// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "kernel/dexel/solid_snapshot.h"
#include "server/formats/mesh_file.h"
#include "server/formats/model/model_writer.h"
#include "server/formats/model/simplify_mesh.h"
#include "server/formats/scene.h"
#include "server/verify/deviation.h"

namespace kerf {

/// A model file requested on the command line.
struct ModelChoice {
  ModelFormat format = ModelFormat::kStl;
  std::filesystem::path path;
  ModelEncoding encoding = ModelEncoding::kBinary;
};

/// Processing of the surface before it is written.
struct SurfaceRequest {
  SimplifyRequest simplify;                        ///< not simplified without limits
  std::optional<std::filesystem::path> reference;  ///< measure the deviation from this mesh
  std::optional<double> range_mm;  ///< range of the colors; default: the 99th percentile
  Vec3 translate_mm;               ///< added to the coordinates in the files
};

/// Results of the processing, for the report.
struct SurfaceReport {
  std::optional<std::uint64_t> exact_triangles;  ///< before simplification
  std::optional<double> simplify_error_mm;
  std::size_t crossing_triangles = 0;  ///< after simplification (simplify_mesh.h)
  std::optional<DistanceFigures> deviation;
  double range_mm = 0;  ///< of the colors
};

struct WrittenModel {
  std::uint64_t triangles = 0;
  std::vector<std::string> warnings;  ///< one line each: lost detail, an exceeded limit
};

/// Adds the greatest number of triangles of some files, if any, and their warnings.
void add_written(std::span<const WrittenModel> files, std::optional<std::uint64_t>& triangles,
                 std::vector<std::string>& warnings);

/// Reads a mesh to compare with, if one is named, placed and repaired according to `as`, whose file
/// is not used. Repairs, and the error, are reported in one line.
std::expected<std::optional<IndexedMesh>, std::string> load_reference(
    const std::optional<std::filesystem::path>& file, MeshFile as,
    const std::function<void(std::string)>& say);

/// Reports the question about the unit of such a mesh (unit_question), compared with the stock.
void ask_for_unit(const std::optional<std::filesystem::path>& file, MeshFile as,
                  const std::optional<IndexedMesh>& mesh, const Scene& scene,
                  const std::function<void(std::string)>& say);

/// The processed surface of a carved block, which any number of threads may write concurrently.
class CarvedSurface {
 public:
  /// `reference` may be null. `workers` mesh, and must outlive the surface. The error is one
  /// sentence. Ends early if a stop is requested. The result must then not be used.
  static std::expected<std::unique_ptr<CarvedSurface>, std::string> make(
      const SolidSnapshot& snapshot, const SurfaceRequest& request, const IndexedMesh* reference,
      const ModelProgress& progress, const std::stop_token& stop, Workers& workers);

  const SurfaceReport& report() const { return report_; }
  /// Writes a model file. The error is one sentence.
  std::expected<WrittenModel, std::string> write(const ModelChoice& choice,
                                                 const std::filesystem::path& path,
                                                 const std::string& title,
                                                 const ModelProgress& progress,
                                                 const std::stop_token& stop) const;

 private:
  CarvedSurface(const SolidSnapshot& snapshot, Vec3 translate_mm, Workers& workers)
      : snapshot_(snapshot), translate_mm_(translate_mm), workers_(workers) {}
  std::unique_ptr<MeshSource> plain() const;

  SolidSnapshot snapshot_;
  Vec3 translate_mm_;
  Workers& workers_;
  bool compared_ = false;  ///< with a reference
  std::optional<IndexedMesh> simplified_;
  std::optional<Deviation> deviation_;
  SurfaceReport report_;
};

}  // namespace kerf
