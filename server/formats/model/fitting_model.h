// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "kernel/dexel/solid_snapshot.h"
#include "server/formats/model/model_limits.h"
#include "server/formats/model/model_writer.h"

namespace kerf {

struct ModelLimits {
  std::uint64_t bytes = kModelBytesMax;
  std::uint64_t triangles = kModelTrianglesMax;
  /// Larger surfaces are not simplified, because that would need more than 2.4 GB.
  std::uint64_t simplified_max = 8'000'000;
};

struct FittingModel {
  ModelSummary summary;  ///< of the written file
  /// If the exact surface exceeded the limits and was simplified: its triangles, and the tolerance.
  std::optional<std::uint64_t> exact_triangles = {};
  double tolerance_mm = 0;
};

/// Writes the exact surface of a block (write_model) if its file is within the limits. Otherwise
/// simplifies it within a twentieth, a fifth or the whole of the pitch, the first that meets the
/// limits, or the last. The surface itself errs by as much: by 0.9 of the pitch where walls end. A
/// surface that is too large to simplify is written unchanged. Equal blocks give equal bytes.
std::expected<FittingModel, ModelError> write_fitting_model(const std::filesystem::path& path,
                                                            const SolidSnapshot& snapshot,
                                                            const ModelRequest& request,
                                                            const ModelLimits& limits = {});

}  // namespace kerf
