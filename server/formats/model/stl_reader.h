// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <span>
#include <stop_token>
#include <vector>

#include "kernel/math/vec3.h"
#include "server/formats/model/mesh_file_error.h"

namespace kerf {

/// Corners in mm, counter-clockwise seen from outside.
using StlTriangle = std::array<Vec3, 3>;

/// Default limit of facets.
inline constexpr std::uint64_t kStlFacetsMax = 20'000'000;

/// Reads a binary or ASCII STL file. Facet normals are ignored, because they are often wrong. The
/// order of the corners defines the orientation. A file that begins with "solid" is binary if its
/// length matches its facet count. Ends soon after a stop is requested (kStopped).
std::expected<std::vector<StlTriangle>, MeshFileError> read_stl(
    std::span<const std::byte> bytes, std::uint64_t facets_max = kStlFacetsMax,
    const std::stop_token& stop = {});

/// Returns the size of a binary STL file with this many facets, bytes.
constexpr std::uint64_t stl_file_bytes(std::uint64_t facets) { return 84 + 50 * facets; }

}  // namespace kerf
