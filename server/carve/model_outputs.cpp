// SPDX-License-Identifier: Apache-2.0
#include "server/carve/model_outputs.h"

#include <algorithm>

#include "server/formats/text_file.h"

namespace kerf {
namespace {

/// Smallest range of the colors, mm.
constexpr double kRangeMinMm = 1e-6;
/// Spacing of the samples for the figures, in pitches.
constexpr double kSpacingPitches = 2;

}  // namespace

std::expected<IndexedMesh, std::string> load_reference(
    const std::filesystem::path& file, MeshFile as, const std::function<void(std::string)>& say) {
  const auto bytes = read_file(file);
  if (!bytes) return std::unexpected(file.string() + ": cannot be read");
  as.file = file.string();
  const auto loaded = load_mesh(as, std::as_bytes(std::span(*bytes)));
  if (!loaded) return std::unexpected(file.string() + ": " + loaded.error());
  if (const std::string repaired = to_string(loaded->repair); !repaired.empty())
    say(file.string() + ": " + repaired);
  return indexed_mesh(loaded->mesh);
}

std::unique_ptr<MeshSource> CarvedSurface::plain() const {
  if (simplified_) return std::make_unique<WholeMesh>(*simplified_);
  // Deviations vary along a face that no cut has reached.
  return std::make_unique<SnapshotMesh>(
      snapshot_, compared_ ? FlatFaces::kByTile : FlatFaces::kMerged, &workers_);
}

std::expected<std::unique_ptr<CarvedSurface>, std::string> CarvedSurface::make(
    const SolidSnapshot& snapshot, const SurfaceRequest& request, const IndexedMesh* reference,
    const ModelProgress& progress, const std::stop_token& stop, Workers& workers) {
  std::unique_ptr<CarvedSurface> surface(new CarvedSurface(snapshot, workers));
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

std::expected<std::uint64_t, std::string> CarvedSurface::write(const ModelChoice& choice,
                                                               const std::filesystem::path& path,
                                                               const std::string& title,
                                                               const ModelProgress& progress,
                                                               const std::stop_token& stop) const {
  std::unique_ptr<MeshSource> mesh = plain();
  if (deviation_) {
    mesh = std::make_unique<DeviationMesh>(std::move(mesh), *deviation_, report_.range_mm);
  }
  const auto written = write_model(path, *mesh,
                                   {.format = choice.format,
                                    .encoding = choice.encoding,
                                    .title = title,
                                    .progress = progress,
                                    .stop = stop});
  if (!written) return std::unexpected(written.error().reason);
  return written->triangles;
}

}  // namespace kerf
