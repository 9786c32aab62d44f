// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace kerf {

/// Limits of a mesh that a server accepts as a part to compare with, in bytes of its file and in
/// triangles. A server's own models stay within them unless more is requested, so that a downloaded
/// model can be uploaded again.
inline constexpr std::size_t kModelBytesMax = std::size_t{64} << 20;
inline constexpr std::uint64_t kModelTrianglesMax = 1'000'000;

}  // namespace kerf
