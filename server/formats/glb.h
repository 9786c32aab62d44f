#pragma once

#include <cstddef>
#include <expected>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/dexel/dexel_snapshot.h"
#include "server/formats/stl.h"

namespace kerf {

struct GlbError {
  std::string reason;  ///< one sentence
};

/// The surface of a whole snapshot as one GLB (glTF 2.0, float positions and normals, one node per
/// tile) for download. glTF is in metres with +Y up: the root node `kerf` carries scale 0.001 and
/// the rotation Z-up to Y-up, and its children are in mm, Z up, from the block's minimum corner.
/// Fails only where the model exceeds GLB's 4 GiB.
std::expected<std::vector<std::byte>, GlbError> make_model_glb(const DexelSnapshot& snapshot,
                                                               std::string_view scene_name,
                                                               const MeshProgress& progress = {});

/// make_model_glb into a file, which appears under its name only when it is complete.
std::expected<void, GlbError> write_model_glb_file(const std::filesystem::path& path,
                                                   const DexelSnapshot& snapshot,
                                                   std::string_view scene_name,
                                                   const MeshProgress& progress = {});

}  // namespace kerf
