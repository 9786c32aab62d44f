// SPDX-License-Identifier: Apache-2.0
#include "server/carve/model_outputs.h"

#include <algorithm>

#include "kernel/dexel/stock_column.h"
#include "server/formats/model/model_limits.h"
#include "server/formats/number_text.h"
#include "server/formats/text_file.h"
#include "server/formats/unit_question.h"
#include "server/verify/part_model.h"

namespace kerf {
namespace {

/// Smallest range of the colors, mm.
constexpr double kRangeMinMm = 1e-6;
/// Spacing of the samples for the figures, in pitches.
constexpr double kSpacingPitches = 2;
/// A proposed tolerance, in pitches.
constexpr double kProposedPitches = 0.05;

std::string too_large_for_parts(const ModelSummary& model, double pitch_mm) {
  return std::to_string(model.triangles) + " triangles in " + std::to_string(model.bytes) +
         " bytes; a server takes parts of at most " + std::to_string(kModelTrianglesMax) + " in " +
         std::to_string(kModelBytesMax) + ": --max-error " +
         exact_text(kProposedPitches * pitch_mm) + " makes fewer";
}

}  // namespace

void add_written(std::span<const WrittenModel> files, std::optional<std::uint64_t>& triangles,
                 std::vector<std::string>& warnings) {
  for (const WrittenModel& file : files) {
    triangles = std::max(triangles.value_or(0), file.triangles);
    warnings.insert(warnings.end(), file.warnings.begin(), file.warnings.end());
  }
}

std::expected<std::optional<IndexedMesh>, std::string> load_reference(
    const std::optional<std::filesystem::path>& file, MeshFile as,
    const std::function<void(std::string)>& say) {
  if (!file) return std::nullopt;
  const auto bytes = read_file(*file);
  if (!bytes) return std::unexpected(file->string() + ": cannot be read");
  as.file = file->string();
  const auto loaded = load_mesh(as, std::as_bytes(std::span(*bytes)));
  if (!loaded) return std::unexpected(as.file + ": " + loaded.error());
  if (const std::string repaired = to_string(loaded->repair); !repaired.empty())
    say(as.file + ": " + repaired);
  return indexed_mesh(loaded->mesh);
}

void ask_for_unit(const std::optional<std::filesystem::path>& file, MeshFile as,
                  const std::optional<IndexedMesh>& mesh, const Scene& scene,
                  const std::function<void(std::string)>& say) {
  if (!file || !mesh) return;
  as.file = file->string();
  const double stock_mm = greatest_side_mm(stock_bounds(scene.settings.stock));
  if (const auto question = unit_question("--reference-unit", as, bounds_of(*mesh), stock_mm))
    say(question->text);
}

std::unique_ptr<MeshSource> CarvedSurface::plain() const {
  if (simplified_) return std::make_unique<WholeMesh>(*simplified_);
  // Deviations vary along an uncut face.
  return std::make_unique<SnapshotMesh>(
      snapshot_, compared_ ? FlatFaces::kByTile : FlatFaces::kMerged, &workers_);
}

std::expected<std::unique_ptr<CarvedSurface>, std::string> CarvedSurface::make(
    const SolidSnapshot& snapshot, const SurfaceRequest& request, const IndexedMesh* reference,
    const ModelProgress& progress, const std::stop_token& stop, Workers& workers) {
  std::unique_ptr<CarvedSurface> surface(
      new CarvedSurface(snapshot, request.translate_mm, workers));
  SurfaceReport& report = surface->report_;
  surface->compared_ = reference != nullptr;
  if (request.simplify.triangles || request.simplify.error_mm) {
    SnapshotMesh exact(snapshot, FlatFaces::kMerged, &workers);
    auto simplified = simplify_mesh(exact, request.simplify, progress, stop);
    if (!simplified) return std::unexpected(simplified.error().reason);
    report.exact_triangles = simplified->original_triangles;
    report.simplify_error_mm = simplified->error_mm;
    report.crossing_triangles = simplified->crossing_triangles;
    surface->simplified_ = std::move(simplified->mesh);
  }
  if (reference != nullptr) {
    const auto mesh = surface->plain();
    surface->deviation_ =
        measure_deviation(*mesh, MeshDistance(*reference),
                          kSpacingPitches * snapshot.grid().pitch_mm, progress, stop);
    report.deviation = surface->deviation_->figures;
    report.range_mm = std::max(request.range_mm.value_or(report.deviation->p99_mm), kRangeMinMm);
  }
  return surface;
}

std::expected<WrittenModel, std::string> CarvedSurface::write(const ModelChoice& choice,
                                                              const std::filesystem::path& path,
                                                              const std::string& title,
                                                              const ModelProgress& progress,
                                                              const std::stop_token& stop) const {
  std::unique_ptr<MeshSource> mesh = plain();
  const Vec3 least_mm = mesh->origin_mm(), size_mm = mesh->size_mm();
  if (deviation_) {
    mesh = std::make_unique<DeviationMesh>(std::move(mesh), *deviation_, report_.range_mm);
  }
  const auto written = write_model(path, *mesh,
                                   {.format = choice.format,
                                    .encoding = choice.encoding,
                                    .title = title,
                                    .shift_mm = translate_mm_,
                                    .progress = progress,
                                    .stop = stop});
  if (!written) return std::unexpected(written.error().reason);
  WrittenModel model{.triangles = written->triangles, .warnings = {}};
  const double pitch_mm = snapshot_.grid().pitch_mm;
  if (auto coarse = coarse_coordinates(*written, pitch_mm, least_mm, size_mm, "--model-translate");
      !coarse.empty())
    model.warnings.push_back(choice.path.string() + ": " + coarse);
  if (written->bytes > kModelBytesMax || written->triangles > kModelTrianglesMax)
    model.warnings.push_back(choice.path.string() + ": " + too_large_for_parts(*written, pitch_mm));
  return model;
}

}  // namespace kerf
