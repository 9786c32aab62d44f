#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/dexel/dexel_snapshot.h"
#include "kernel/math/vec3.h"

namespace kerf {

enum class StlErrorCode {
  kTruncated,      ///< the file ends inside its header, a facet or a statement
  kCountMismatch,  ///< more bytes than the facet count accounts for
  kNotFinite,      ///< a coordinate is NaN or infinite
  kTooLarge,       ///< more facets than the caller allows
  kSyntax,         ///< ASCII: a word that is not STL
  kEmpty,          ///< no facet at all
  kCannotWrite     ///< the output file cannot be created or written
};
struct StlError {
  StlErrorCode code;
  std::string reason;  ///< one sentence, with the byte, line or facet number
};
/// The name of a code as reports write it, e.g. "count_mismatch".
const char* to_string(StlErrorCode code);

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

/// Called now and then with the share of the work done, 0 to 1; may be empty.
using MeshProgress = std::function<void(double)>;

/// The surface of a whole snapshot as a binary STL, produced piece by piece so that no whole model
/// is ever in memory. Construction meshes everything once to count facets, so the length is known
/// before the first byte (HTTP needs it). Coordinates are mm in the scene's frame. Not thread-safe;
/// different streams of one snapshot may run in parallel.
class StlStream {
 public:
  /// `title` goes into the 80-byte header (cut there; never starts with "solid").
  StlStream(DexelSnapshot snapshot, std::string_view title, const MeshProgress& progress = {});

  std::uint64_t facets() const { return facets_; }
  std::uint64_t total_bytes() const { return stl_file_bytes(facets_); }
  /// Replaces `chunk` by the next bytes (about one tile). False, and `chunk` empty, at the end.
  bool next(std::vector<std::byte>& chunk);

 private:
  DexelSnapshot snapshot_;
  std::string title_;
  std::uint64_t facets_ = 0;
  std::int64_t next_tile_ = -1;  ///< -1: the header comes first
};

struct StlSummary {
  std::uint64_t facets = 0, bytes = 0;
};
/// Writes the snapshot's surface to a file in one meshing pass (the count is patched in
/// afterwards). The file appears under its name only when it is complete; on an error nothing is
/// left behind.
std::expected<StlSummary, StlError> write_stl_file(const std::filesystem::path& path,
                                                   const DexelSnapshot& snapshot,
                                                   std::string_view title,
                                                   const MeshProgress& progress = {});

}  // namespace kerf
