// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/fitting_model.h"

#include "server/formats/model/mesh_source.h"
#include "server/formats/model/simplify_mesh.h"

namespace kerf {
namespace {

constexpr double kTolerancePitches[] = {0.05, 0.2, 1};

bool keeps(const ModelSummary& summary, const ModelLimits& limits) {
  return summary.bytes <= limits.bytes && summary.triangles <= limits.triangles;
}

}  // namespace

std::expected<FittingModel, ModelError> write_fitting_model(const std::filesystem::path& path,
                                                            const SolidSnapshot& snapshot,
                                                            const ModelRequest& request,
                                                            const ModelLimits& limits) {
  SnapshotMesh exact(snapshot);
  const auto whole = write_model(path, exact, request);
  if (!whole) return std::unexpected(whole.error());
  FittingModel model;
  model.summary = *whole;
  if (whole->triangles > limits.simplified_max) return model;
  for (const double pitches : kTolerancePitches) {
    if (keeps(model.summary, limits)) break;
    model.exact_triangles = whole->triangles;
    model.tolerance_mm = pitches * snapshot.grid().pitch_mm;
    SnapshotMesh again(snapshot);
    const auto simplified = simplify_mesh(again, {.triangles = {}, .error_mm = model.tolerance_mm},
                                          request.progress, request.stop);
    if (!simplified) return std::unexpected(simplified.error());
    WholeMesh mesh(simplified->mesh);
    const auto written = write_model(path, mesh, request);
    if (!written) return std::unexpected(written.error());
    model.summary = *written;
  }
  return model;
}

}  // namespace kerf
