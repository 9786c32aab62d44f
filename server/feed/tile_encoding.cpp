// SPDX-License-Identifier: Apache-2.0
#include "server/feed/tile_encoding.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <mutex>
#include <numeric>
#include <string_view>

namespace kerf {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF is little-endian");

/// Limit of the steps that a tile spans: below 65536, with a margin for rounding at both ends.
constexpr double kStepsMax = 65000;
/// Most halvings of the pitch for the step. With 256 steps per pitch, neighboring columns differ by
/// one in the upper byte of a coordinate and not in the lower one, which suits the byte-wise codec
/// best: 128 or 64 steps would take half as many bytes again.
constexpr int kStepHalvingsMax = 8;
/// Bound of the span of a tile's vertices, pitches: its columns, half a cell on each side, a
/// margin.
constexpr int kTileSpanPitches = kTileSide + 2;
/// The largest 16-bit index is reserved.
constexpr std::uint32_t kShortIndexVerticesMax = 65535;
constexpr float kNormalScale = 127;
/// Added before a cast truncates, so that negative values are rounded down too.
constexpr std::int32_t kStepBias = 1 << 16;

constexpr std::uint32_t kNoPlace = std::numeric_limits<std::uint32_t>::max();

template <typename T>
void put(std::byte* at, T value) {
  std::memcpy(at, &value, sizeof(T));
}

/// The vertices and triangles of a mesh in the order in which they are sent.
struct SendOrder {
  std::vector<std::uint32_t> vertices;  ///< vertex of the mesh, by position in the order
  std::vector<std::uint32_t> indices;   ///< positions in `vertices`, three per triangle
};

SendOrder order_of_mesh(const TileMesh& mesh) {
  SendOrder order{std::vector<std::uint32_t>(mesh.positions_mm.size()), mesh.indices};
  std::iota(order.vertices.begin(), order.vertices.end(), 0U);
  return order;
}

/// An order that the codecs compress well: every triangle shares an edge with a recent one, and
/// vertices are numbered by first use. The mesher already emits quadrangles row by row, as two
/// triangles with the diagonal first. So it suffices to start each quadrangle with the triangle
/// next to the previous one: the one whose own corner was used later. A general search for strips
/// gives more bytes and takes ten times as long.
class RowOrder {
 public:
  explicit RowOrder(const TileMesh& mesh) : place_(mesh.positions_mm.size(), kNoPlace) {
    order_.vertices.reserve(place_.size());
    order_.indices.reserve(mesh.indices.size());
    const std::uint32_t* const end = mesh.indices.data() + mesh.indices.size();
    for (const std::uint32_t* t = mesh.indices.data(); t != end; t += 3) {
      const bool quadrangle = end - t >= 6 && t[0] == t[3] && t[2] == t[4];
      if (!quadrangle) {
        add(t);
        continue;
      }
      // An unused corner counts as the oldest.
      const bool swapped = place_[t[5]] + 1 > place_[t[1]] + 1;
      add(swapped ? t + 3 : t);
      add(swapped ? t : t + 3);
      t += 3;
    }
  }
  SendOrder take() { return std::move(order_); }

 private:
  void add(const std::uint32_t* corners) {
    for (int n = 0; n < 3; ++n) {
      std::uint32_t& place = place_[corners[n]];
      if (place == kNoPlace) {
        place = static_cast<std::uint32_t>(order_.vertices.size());
        order_.vertices.push_back(corners[n]);
      }
      order_.indices.push_back(place);
    }
  }

  std::vector<std::uint32_t> place_;  ///< by vertex of the mesh
  SendOrder order_;
};

using Steps = std::array<std::int32_t, 3>;

void encode_positions(const TileMesh& mesh, const SendOrder& order,
                      const MeshQuantization& quantization, EncodedTile& out) {
  std::vector<Steps> steps(order.vertices.size());
  const double per_mm = 1 / quantization.step_mm;
  Steps low, high;
  low.fill(std::numeric_limits<std::int32_t>::max());
  high.fill(std::numeric_limits<std::int32_t>::min());
  for (std::size_t v = 0; v < steps.size(); ++v) {
    const auto& position = mesh.positions_mm[order.vertices[v]];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double exact = static_cast<double>(position[axis]) * per_mm;
      const auto step = static_cast<std::int32_t>(exact + (kStepBias + 0.5)) - kStepBias;
      steps[v][axis] = step;
      low[axis] = std::min(low[axis], step);
      high[axis] = std::max(high[axis], step);
    }
  }
  const Vec3& o = quantization.origin_mm;
  const std::array<double, 3> origin{o.x, o.y, o.z};
  Steps center{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    center[axis] = (low[axis] + high[axis] + 1) / 2;
    out.translation_mm[axis] = origin[axis] + center[axis] * quantization.step_mm;
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

void encode_normals(const TileMesh& mesh, const SendOrder& order, EncodedTile& out) {
  out.normals.resize(order.vertices.size() * EncodedTile::kNormalStride);
  std::byte* at = out.normals.data();
  for (const std::uint32_t v : order.vertices) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float scaled = mesh.normals[v][axis] * kNormalScale;
      const auto rounded = static_cast<int>(scaled + (kNormalScale + 0.5F));
      put(at + axis, static_cast<std::int8_t>(rounded - static_cast<int>(kNormalScale)));
    }
    put(at + 3, mesh.original[v]);
    at += EncodedTile::kNormalStride;
  }
}

void encode_indices(const SendOrder& order, EncodedTile& out) {
  const std::size_t stride = out.index_stride();
  out.index_bytes.resize(order.indices.size() * stride);
  for (std::size_t n = 0; n < order.indices.size(); ++n) {
    std::byte* at = out.index_bytes.data() + n * stride;
    if (out.wide_indices) {
      put(at, order.indices[n]);
    } else {
      put(at, static_cast<std::uint16_t>(order.indices[n]));
    }
  }
}

std::vector<std::byte> compressed_vertices(const std::vector<std::byte>& raw, std::size_t count,
                                           std::size_t stride) {
  std::vector<std::byte> out(meshopt_encodeVertexBufferBound(count, stride));
  out.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(),
                                        raw.data(), count, stride));
  out.shrink_to_fit();  // tiles are cached
  return out;
}

std::vector<std::byte> compressed_indices(const SendOrder& order) {
  const std::vector<std::uint32_t>& indices = order.indices;
  std::vector<std::byte> out(meshopt_encodeIndexBufferBound(indices.size(), order.vertices.size()));
  out.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(),
                                       indices.data(), indices.size()));
  out.shrink_to_fit();
  return out;
}

/// Selects the codec versions that EXT_meshopt_compression requires. They are global state of the
/// library.
void fix_codec_versions() {
  static std::once_flag versions_set;
  std::call_once(versions_set, [] {
    meshopt_encodeVertexVersion(0);
    meshopt_encodeIndexVersion(1);
  });
}

std::uint64_t hash_of(const EncodedTile& tile) {
  std::uint64_t hash = tile.indices;
  for (const auto* bytes : {&tile.positions, &tile.normals, &tile.index_bytes}) {
    const std::string_view text{reinterpret_cast<const char*>(bytes->data()), bytes->size()};
    hash = std::rotl(hash, 21) ^ std::hash<std::string_view>{}(text);
  }
  return hash;
}

}  // namespace

bool EncodedTile::has_shape_of(const EncodedTile& other) const {
  return shape_hash == other.shape_hash && compression == other.compression &&
         vertices == other.vertices && indices == other.indices && min == other.min &&
         max == other.max && positions == other.positions && normals == other.normals &&
         index_bytes == other.index_bytes;
}

MeshQuantization mesh_quantization(const DexelGrid& grid) {
  const double span =
      std::max(grid.height_quanta * grid.z_quantum_mm, kTileSpanPitches * grid.pitch_mm);
  double step = grid.pitch_mm;
  for (int n = 0; n < kStepHalvingsMax && 2 * span <= step * kStepsMax; ++n) step /= 2;
  while (span > step * kStepsMax) step *= 2;
  return {grid.origin_mm, step, kTileSide * grid.pitch_mm};
}

EncodedTile encode_tile(const TileMesh& mesh, const MeshQuantization& quantization,
                        std::uint32_t version, TileCompression compression) {
  EncodedTile out;
  out.tile = mesh.tile;
  out.version = version;
  if (mesh.indices.empty()) return out;
  out.compression = compression;
  out.vertices = static_cast<std::uint32_t>(mesh.positions_mm.size());
  out.indices = static_cast<std::uint32_t>(mesh.indices.size());
  out.wide_indices = out.vertices > kShortIndexVerticesMax;
  const bool packed = compression == TileCompression::kMeshopt;
  const SendOrder order = packed ? RowOrder(mesh).take() : order_of_mesh(mesh);
  encode_positions(mesh, order, quantization, out);
  encode_normals(mesh, order, out);
  if (!packed) {
    encode_indices(order, out);
  } else {
    fix_codec_versions();
    out.positions = compressed_vertices(out.positions, out.vertices, EncodedTile::kPositionStride);
    out.normals = compressed_vertices(out.normals, out.vertices, EncodedTile::kNormalStride);
    out.index_bytes = compressed_indices(order);
  }
  out.shape_hash = hash_of(out);
  return out;
}

}  // namespace kerf
