// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

namespace kerf {

/// What a mesh has at most that a server takes as a part to compare with, in bytes of its file and
/// in triangles. A model that a server gives has no more, unless more is asked for, so that what
/// was taken home can be brought back.
inline constexpr std::size_t kModelBytesMax = std::size_t{64} << 20;
inline constexpr std::uint64_t kModelTrianglesMax = 1'000'000;

}  // namespace kerf
