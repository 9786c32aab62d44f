// SPDX-License-Identifier: Apache-2.0
// The formats of models whose libraries are not compiled for pages: glTF, and reading 3MF.

#include "server/formats/model/mesh_reader.h"
#include "server/formats/model/model_parts.h"

namespace kerf {
namespace {

MeshFileResult not_here(const char* format) {
  return std::unexpected(
      MeshFileError{MeshFileErrorCode::kUnsupported,
                    std::string(format) + " is not read without a server: give STL, PLY or OBJ"});
}

}  // namespace

MeshFileResult read_threemf(std::span<const std::byte>, std::uint64_t, const std::stop_token&) {
  return not_here("3MF");
}
MeshFileResult read_gltf(std::span<const std::byte>, std::uint64_t, const std::stop_token&) {
  return not_here("GLB");
}
ModelResult write_glb(const ModelOutput&) { return model_error("GLB is not written here"); }

}  // namespace kerf
