// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <span>
#include <vector>

#include "kernel/math/vec3.h"
#include "server/formats/model/mesh_file_error.h"

namespace kerf {

/// Corners in mm, counter-clockwise seen from outside.
using StlTriangle = std::array<Vec3, 3>;

/// Most facets that read_stl accepts unless told otherwise.
inline constexpr std::uint64_t kStlFacetsMax = 20'000'000;

/// Reads a binary or an ASCII STL. Facet normals are ignored (they are often wrong): the order of
/// the corners decides. A file that starts with "solid" is still read as binary when its length is
/// exactly what its facet count says.
std::expected<std::vector<StlTriangle>, MeshFileError> read_stl(
    std::span<const std::byte> bytes, std::uint64_t facets_max = kStlFacetsMax);

/// Bytes of a binary STL file with this many facets.
constexpr std::uint64_t stl_file_bytes(std::uint64_t facets) { return 84 + 50 * facets; }

}  // namespace kerf
