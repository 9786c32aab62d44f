// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <stop_token>
#include <string_view>

#include "kernel/dexel/triangle_mesh.h"
#include "server/formats/model/mesh_file_error.h"

namespace kerf {

/// Default limit of triangles in a mesh file.
inline constexpr std::uint64_t kMeshTrianglesMax = 20'000'000;

enum class MeshFileFormat { kStl, kPly, kObj, k3mf, kGlb };
/// The extensions as an error lists them.
inline constexpr const char* kMeshFileNames = ".stl, .ply, .obj, .3mf or .glb";
/// Returns the format by the extension of a file name, ignoring case, or nullopt.
std::optional<MeshFileFormat> mesh_file_format(std::string_view file_name);

using MeshFileResult = std::expected<TriangleMesh, MeshFileError>;

/// Reads a mesh: STL (binary, ASCII), PLY (ASCII, both byte orders), OBJ (8-bit, UTF-16), 3MF,
/// binary glTF. Coordinates are the file's numbers, in 3MF and GLB mm by the file's unit and +Z up.
/// Polygons are split into fans of triangles. Colors, normals, textures and other attributes are
/// ignored. Vertices with equal coordinates are merged, as are those on open edges nearer than 1e-6
/// of the diagonal. Triangles with two equal corners are dropped. The time is linear in the bytes
/// and triangles for any content. Ends soon after a stop is requested (kStopped).
MeshFileResult read_mesh(MeshFileFormat format, std::span<const std::byte> bytes,
                         std::uint64_t triangles_max = kMeshTrianglesMax,
                         const std::stop_token& stop = {});

/// Read one format without merging vertices.
MeshFileResult read_ply(std::span<const std::byte> bytes, std::uint64_t triangles_max,
                        const std::stop_token& stop);
MeshFileResult read_obj(std::string_view text, std::uint64_t triangles_max,
                        const std::stop_token& stop);
MeshFileResult read_threemf(std::span<const std::byte> bytes, std::uint64_t triangles_max,
                            const std::stop_token& stop);
MeshFileResult read_gltf(std::span<const std::byte> bytes, std::uint64_t triangles_max,
                         const std::stop_token& stop);

}  // namespace kerf
