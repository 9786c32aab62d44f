// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string_view>

#include "kernel/dexel/triangle_mesh.h"
#include "server/formats/model/mesh_file_error.h"

namespace kerf {

/// Most triangles that a mesh file may have unless told otherwise.
inline constexpr std::uint64_t kMeshTrianglesMax = 20'000'000;

enum class MeshFileFormat { kStl, kPly, kObj };
/// By the extension of a file name, whatever its case; none for anything else.
std::optional<MeshFileFormat> mesh_file_format(std::string_view file_name);

using MeshFileResult = std::expected<TriangleMesh, MeshFileError>;

/// Reads a mesh: STL (binary, ASCII), PLY (ascii, both byte orders), OBJ. Polygons become fans of
/// triangles; colours, normals, textures and everything else beside the surface are left out.
/// Vertices with equal coordinates become one, and triangles with two equal corners are dropped:
/// they enclose nothing.
MeshFileResult read_mesh(MeshFileFormat format, std::span<const std::byte> bytes,
                         std::uint64_t triangles_max = kMeshTrianglesMax);

/// The formats by themselves, as they stand in the file.
MeshFileResult read_ply(std::span<const std::byte> bytes, std::uint64_t triangles_max);
MeshFileResult read_obj(std::string_view text, std::uint64_t triangles_max);

}  // namespace kerf
