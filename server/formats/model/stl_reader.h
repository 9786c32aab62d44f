#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <vector>

#include "kernel/math/vec3.h"

namespace kerf {

enum class StlErrorCode {
  kTruncated,      ///< the file ends inside its header, a facet or a statement
  kCountMismatch,  ///< more bytes than the facet count accounts for
  kNotFinite,      ///< a coordinate is NaN or infinite
  kTooLarge,       ///< more facets than the caller allows
  kSyntax,         ///< ASCII: a word that is not STL
  kEmpty           ///< no facet at all
};
struct StlError {
  StlErrorCode code;
  std::string reason;  ///< one sentence, with the byte, line or facet number
};

/// Corners in mm, counter-clockwise seen from outside.
using StlTriangle = std::array<Vec3, 3>;

/// Most facets that read_stl accepts unless told otherwise.
inline constexpr std::uint64_t kStlFacetsMax = 20'000'000;

/// Reads a binary or an ASCII STL. Facet normals are ignored (they are often wrong): the order of
/// the corners decides. A file that starts with "solid" is still read as binary when its length is
/// exactly what its facet count says.
std::expected<std::vector<StlTriangle>, StlError> read_stl(
    std::span<const std::byte> bytes, std::uint64_t facets_max = kStlFacetsMax);

/// Bytes of a binary STL file with this many facets.
constexpr std::uint64_t stl_file_bytes(std::uint64_t facets) { return 84 + 50 * facets; }

}  // namespace kerf
