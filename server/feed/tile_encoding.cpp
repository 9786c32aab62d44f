#include "server/feed/tile_encoding.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>

namespace kerf {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF is little-endian");

/// Steps that a tile may span: below 65536, so that rounding at both ends still fits.
constexpr double kStepsMax = 65000;
/// Finer than this share of the pitch, more bits would only carry noise.
constexpr double kStepMinPitches = 1.0 / 4096;
/// Pitches that a tile's vertices may span: its columns and half a cell on each side, and some.
constexpr int kTileSpanPitches = kTileSide + 2;
/// The largest 16-bit index is reserved.
constexpr std::uint32_t kShortIndexVerticesMax = 65535;
constexpr float kNormalScale = 127;

using Steps = std::array<std::int64_t, 3>;

template <typename T>
void put(std::byte* at, T value) {
  std::memcpy(at, &value, sizeof(T));
}

void encode_positions(const TileMesh& mesh, const MeshQuantization& quantization,
                      EncodedTile& out) {
  std::vector<Steps> steps(mesh.positions_mm.size());
  Steps low, high;
  low.fill(std::numeric_limits<std::int64_t>::max());
  high.fill(std::numeric_limits<std::int64_t>::min());
  for (std::size_t v = 0; v < steps.size(); ++v) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto mm = static_cast<double>(mesh.positions_mm[v][axis]);
      steps[v][axis] = static_cast<std::int64_t>(std::floor(mm / quantization.step_mm + 0.5));
      low[axis] = std::min(low[axis], steps[v][axis]);
      high[axis] = std::max(high[axis], steps[v][axis]);
    }
  }
  const Vec3& o = quantization.origin_mm;
  const std::array<double, 3> origin{o.x, o.y, o.z};
  Steps center{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    center[axis] = (low[axis] + high[axis] + 1) / 2;
    out.translation_mm[axis] =
        origin[axis] + static_cast<double>(center[axis]) * quantization.step_mm;
    out.min[axis] = static_cast<std::int16_t>(low[axis] - center[axis]);
    out.max[axis] = static_cast<std::int16_t>(high[axis] - center[axis]);
  }
  out.positions.resize(steps.size() * EncodedTile::kPositionStride);
  for (std::size_t v = 0; v < steps.size(); ++v) {
    std::byte* at = out.positions.data() + v * EncodedTile::kPositionStride;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      put(at + 2 * axis, static_cast<std::int16_t>(steps[v][axis] - center[axis]));
    }
  }
}

void encode_normals(const TileMesh& mesh, EncodedTile& out) {
  out.normals.resize(mesh.normals.size() * EncodedTile::kNormalStride);
  out.normal_min.fill(127);
  out.normal_max.fill(-127);
  for (std::size_t v = 0; v < mesh.normals.size(); ++v) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto value =
          static_cast<std::int8_t>(std::lround(mesh.normals[v][axis] * kNormalScale));
      put(out.normals.data() + v * EncodedTile::kNormalStride + axis, value);
      out.normal_min[axis] = std::min(out.normal_min[axis], value);
      out.normal_max[axis] = std::max(out.normal_max[axis], value);
    }
  }
}

void encode_indices(const TileMesh& mesh, EncodedTile& out) {
  out.wide_indices = out.vertices > kShortIndexVerticesMax;
  const std::size_t stride = out.index_stride();
  out.index_bytes.resize(mesh.indices.size() * stride);
  for (std::size_t n = 0; n < mesh.indices.size(); ++n) {
    std::byte* at = out.index_bytes.data() + n * stride;
    if (out.wide_indices) {
      put(at, mesh.indices[n]);
    } else {
      put(at, static_cast<std::uint16_t>(mesh.indices[n]));
    }
  }
}

std::vector<std::byte> compressed_vertices(const std::vector<std::byte>& raw, std::size_t count,
                                           std::size_t stride) {
  std::vector<std::byte> out(meshopt_encodeVertexBufferBound(count, stride));
  out.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(),
                                        raw.data(), count, stride));
  return out;
}

/// The same mesh with triangles in strips and vertices in the order of their use: that is what the
/// codecs compress well (half of the bytes here), for a quarter of the time that the mesh took.
TileMesh in_strip_order(const TileMesh& mesh) {
  const std::size_t vertices = mesh.positions_mm.size();
  TileMesh out;
  out.tile = mesh.tile;
  out.indices.resize(mesh.indices.size());
  meshopt_optimizeVertexCacheStrip(out.indices.data(), mesh.indices.data(), mesh.indices.size(),
                                   vertices);
  std::vector<std::uint32_t> place(vertices);
  meshopt_optimizeVertexFetchRemap(place.data(), out.indices.data(), out.indices.size(), vertices);
  out.positions_mm.resize(vertices);
  out.normals.resize(vertices);
  for (std::size_t v = 0; v < vertices; ++v) {
    out.positions_mm[place[v]] = mesh.positions_mm[v];
    out.normals[place[v]] = mesh.normals[v];
  }
  for (std::uint32_t& index : out.indices) index = place[index];
  return out;
}

void compress(const TileMesh& mesh, EncodedTile& out) {
  // EXT_meshopt_compression fixes these versions of the two codecs; the library keeps them
  // globally.
  static std::once_flag versions_set;
  std::call_once(versions_set, [] {
    meshopt_encodeVertexVersion(0);
    meshopt_encodeIndexVersion(1);
  });
  out.compression = TileCompression::kMeshopt;
  out.positions = compressed_vertices(out.positions, out.vertices, EncodedTile::kPositionStride);
  out.normals = compressed_vertices(out.normals, out.vertices, EncodedTile::kNormalStride);
  out.index_bytes.resize(meshopt_encodeIndexBufferBound(out.indices, out.vertices));
  out.index_bytes.resize(
      meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(out.index_bytes.data()),
                                out.index_bytes.size(), mesh.indices.data(), mesh.indices.size()));
}

}  // namespace

MeshQuantization mesh_quantization(const DexelGrid& grid) {
  const double span =
      std::max(grid.height_quanta * grid.z_quantum_mm, kTileSpanPitches * grid.pitch_mm);
  const double step_min = std::max(span / kStepsMax, grid.pitch_mm * kStepMinPitches);
  double step = 1;
  while (step < step_min) step *= 2;
  while (step / 2 >= step_min) step /= 2;
  return {grid.origin_mm, step};
}

EncodedTile encode_tile(const TileMesh& mesh, const MeshQuantization& quantization,
                        std::uint32_t version, TileCompression compression) {
  EncodedTile out;
  out.tile = mesh.tile;
  out.version = version;
  if (mesh.indices.empty()) return out;
  out.vertices = static_cast<std::uint32_t>(mesh.positions_mm.size());
  out.indices = static_cast<std::uint32_t>(mesh.indices.size());
  const bool packed = compression == TileCompression::kMeshopt;
  const TileMesh ordered = packed ? in_strip_order(mesh) : TileMesh{};
  const TileMesh& source = packed ? ordered : mesh;
  encode_positions(source, quantization, out);
  encode_normals(source, out);
  encode_indices(source, out);
  if (packed) compress(source, out);
  return out;
}

}  // namespace kerf
