#include "server/formats/stl.h"

#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>
#include <utility>

#include "kernel/surface/tile_mesh.h"

namespace kerf {
namespace {

constexpr std::size_t kHeaderBytes = 84;
constexpr std::size_t kFacetBytes = 50;
constexpr std::size_t kTitleBytes = 80;

void put_u32(std::byte* at, std::uint32_t value) {
  for (int n = 0; n < 4; ++n) at[n] = static_cast<std::byte>(value >> (8 * n));
}

void put_float(std::byte* at, float value) { put_u32(at, std::bit_cast<std::uint32_t>(value)); }

std::array<std::byte, kHeaderBytes> make_header(std::string_view title, std::uint64_t facets) {
  // Readers take a file that starts with "solid" for ASCII; the scene's name may well do so.
  std::string text = "Kerf STL, mm: ";
  text.append(title);
  text.resize(kTitleBytes, ' ');
  std::array<std::byte, kHeaderBytes> header{};
  std::memcpy(header.data(), text.data(), kTitleBytes);
  put_u32(header.data() + kTitleBytes, static_cast<std::uint32_t>(facets));
  return header;
}

/// Appends the facets of a tile. The facet normal is that of the triangle, as the format asks, not
/// a shading normal.
void append_facets(const TileMesh& mesh, Vec3 origin, std::vector<std::byte>& out) {
  const std::size_t facets = mesh.indices.size() / 3;
  const std::size_t first = out.size();
  out.resize(first + facets * kFacetBytes);
  std::byte* at = out.data() + first;
  for (std::size_t f = 0; f < facets; ++f, at += kFacetBytes) {
    std::array<Vec3, 3> corner;
    for (std::size_t c = 0; c < 3; ++c) {
      const auto& p = mesh.positions_mm[mesh.indices[3 * f + c]];
      corner[c] =
          Vec3{static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
    }
    const Vec3 normal = normalized(cross(corner[1] - corner[0], corner[2] - corner[0]));
    const std::array<Vec3, 4> vectors{normal, corner[0] + origin, corner[1] + origin,
                                      corner[2] + origin};
    for (std::size_t v = 0; v < vectors.size(); ++v) {
      put_float(at + 12 * v, static_cast<float>(vectors[v].x));
      put_float(at + 12 * v + 4, static_cast<float>(vectors[v].y));
      put_float(at + 12 * v + 8, static_cast<float>(vectors[v].z));
    }
    at[48] = at[49] = std::byte{0};
  }
}

std::int64_t tile_count(const DexelGrid& grid) {
  return std::int64_t{grid.tiles_x()} * grid.tiles_y();
}

TileIndex tile_at(const DexelGrid& grid, std::int64_t n) {
  return {static_cast<std::int32_t>(n % grid.tiles_x()),
          static_cast<std::int32_t>(n / grid.tiles_x())};
}

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, FileCloser>;

bool write_all(std::FILE* file, std::span<const std::byte> bytes) {
  return std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
}

std::expected<StlSummary, StlError> write_tiles(std::FILE* file, const DexelSnapshot& snapshot,
                                                std::string_view title,
                                                const MeshProgress& progress) {
  const auto failed = [] {
    return std::unexpected(
        StlError{StlErrorCode::kCannotWrite, std::string("write failed: ") + std::strerror(errno)});
  };
  if (!write_all(file, make_header(title, 0))) return failed();
  const DexelGrid& grid = snapshot.grid();
  StlSummary summary;
  std::vector<std::byte> chunk;
  for (std::int64_t n = 0; n < tile_count(grid); ++n) {
    chunk.clear();
    append_facets(mesh_tile(snapshot, tile_at(grid, n)), grid.origin_mm, chunk);
    if (!write_all(file, chunk)) return failed();
    summary.facets += chunk.size() / kFacetBytes;
    if (progress) progress(static_cast<double>(n + 1) / static_cast<double>(tile_count(grid)));
  }
  if (summary.facets > UINT32_MAX) {
    return std::unexpected(StlError{StlErrorCode::kTooLarge,
                                    "the surface has more facets than an STL file can count"});
  }
  if (std::fseek(file, 0, SEEK_SET) != 0 || !write_all(file, make_header(title, summary.facets)) ||
      std::fflush(file) != 0) {
    return failed();
  }
  summary.bytes = stl_file_bytes(summary.facets);
  return summary;
}

}  // namespace

const char* to_string(StlErrorCode code) {
  switch (code) {
    case StlErrorCode::kTruncated:
      return "truncated";
    case StlErrorCode::kCountMismatch:
      return "count_mismatch";
    case StlErrorCode::kNotFinite:
      return "not_finite";
    case StlErrorCode::kTooLarge:
      return "too_large";
    case StlErrorCode::kSyntax:
      return "syntax";
    case StlErrorCode::kEmpty:
      return "empty";
    case StlErrorCode::kCannotWrite:
      return "cannot_write";
  }
  return "unknown";
}

StlStream::StlStream(DexelSnapshot snapshot, std::string_view title, const MeshProgress& progress)
    : snapshot_(std::move(snapshot)), title_(title) {
  const DexelGrid& grid = snapshot_.grid();
  for (std::int64_t n = 0; n < tile_count(grid); ++n) {
    facets_ += mesh_tile(snapshot_, tile_at(grid, n)).indices.size() / 3;
    if (progress) progress(static_cast<double>(n + 1) / static_cast<double>(tile_count(grid)));
  }
}

bool StlStream::next(std::vector<std::byte>& chunk) {
  chunk.clear();
  if (next_tile_ < 0) {
    const auto header = make_header(title_, facets_);
    chunk.assign(header.begin(), header.end());
    next_tile_ = 0;
    return true;
  }
  const DexelGrid& grid = snapshot_.grid();
  while (chunk.empty() && next_tile_ < tile_count(grid)) {
    append_facets(mesh_tile(snapshot_, tile_at(grid, next_tile_)), grid.origin_mm, chunk);
    ++next_tile_;
  }
  return !chunk.empty();
}

std::expected<StlSummary, StlError> write_stl_file(const std::filesystem::path& path,
                                                   const DexelSnapshot& snapshot,
                                                   std::string_view title,
                                                   const MeshProgress& progress) {
  std::filesystem::path part = path;
  part += ".part";
  File file(std::fopen(part.c_str(), "wb"));
  if (!file) {
    return std::unexpected(
        StlError{StlErrorCode::kCannotWrite, path.string() + ": " + std::strerror(errno)});
  }
  auto summary = write_tiles(file.get(), snapshot, title, progress);
  if (std::fclose(file.release()) != 0 && summary) {
    summary = std::unexpected(
        StlError{StlErrorCode::kCannotWrite, std::string("close failed: ") + std::strerror(errno)});
  }
  std::error_code error;
  if (summary) std::filesystem::rename(part, path, error);
  if (error) {
    summary = std::unexpected(
        StlError{StlErrorCode::kCannotWrite, path.string() + ": " + error.message()});
  }
  if (!summary) std::filesystem::remove(part, error);
  return summary;
}

}  // namespace kerf
