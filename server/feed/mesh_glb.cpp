// SPDX-License-Identifier: Apache-2.0
#include "server/feed/mesh_glb.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <string>
#include <string_view>
#include <unordered_map>

#include "server/feed/tile_runs.h"

namespace kerf {
namespace {

constexpr std::size_t padded(std::size_t bytes) { return (bytes + 3) / 4 * 4; }

/// Appends JSON text to a string.
class Json {
 public:
  Json& text(std::string_view raw) {
    out_.append(raw);
    return *this;
  }
  template <typename T>
  Json& number(T value) {
    std::array<char, 32> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    out_.append(digits.data(), end);
    return *this;
  }
  template <typename T>
  Json& triple(const std::array<T, 3>& v) {
    return text("[").number(v[0]).text(",").number(v[1]).text(",").number(v[2]).text("]");
  }
  /// Appends a comma unless `first`, and clears `first`.
  Json& next(bool& first) {
    if (!first) out_.push_back(',');
    first = false;
    return *this;
  }
  /// A string of 16 hexadecimal digits.
  Json& digits(std::uint64_t value) {
    out_.push_back('"');
    for (int shift = 60; shift >= 0; shift -= 4) {
      out_.push_back("0123456789abcdef"[value >> static_cast<unsigned>(shift) & 15U]);
    }
    out_.push_back('"');
    return *this;
  }
  std::string take() { return std::move(out_); }

 private:
  std::string out_;
};

/// One of the three buffer views of a tile.
struct Part {
  const std::vector<std::byte>& bytes;
  std::size_t count, stride;
  bool index;
  std::size_t raw_bytes() const { return count * stride; }
};

std::array<Part, 3> parts_of(const EncodedTile& tile) {
  return {Part{tile.positions, tile.vertices, EncodedTile::kPositionStride, false},
          Part{tile.normals, tile.vertices, EncodedTile::kNormalStride, false},
          Part{tile.index_bytes, tile.indices, tile.index_stride(), true}};
}

struct Sizes {
  std::size_t stored = 0;  ///< bytes in the binary chunk
  std::size_t raw = 0;     ///< size of compressed views after decompression: the fallback buffer
};

/// The meshes of a frame, shared by tiles of the same shape.
struct Meshes {
  std::vector<const EncodedTile*> distinct;  ///< a tile of each shape
  std::vector<std::size_t> of_tile;          ///< mesh of each tile; undefined for empty tiles
};

Meshes meshes_of(std::span<const EncodedTile* const> tiles) {
  Meshes meshes;
  meshes.of_tile.resize(tiles.size());
  std::unordered_map<std::uint64_t, std::size_t> by_hash;
  for (std::size_t n = 0; n < tiles.size(); ++n) {
    if (tiles[n]->vertices == 0) continue;
    const auto [known, is_new] = by_hash.try_emplace(tiles[n]->shape_hash, meshes.distinct.size());
    if (!is_new && tiles[n]->has_shape_of(*meshes.distinct[known->second])) {
      meshes.of_tile[n] = known->second;
    } else {
      meshes.of_tile[n] = meshes.distinct.size();
      meshes.distinct.push_back(tiles[n]);
    }
  }
  return meshes;
}

Sizes sizes_of(const std::vector<const EncodedTile*>& meshes) {
  Sizes sizes;
  for (const EncodedTile* tile : meshes) {
    for (const Part& part : parts_of(*tile)) {
      sizes.stored += padded(part.bytes.size());
      if (tile->compression == TileCompression::kMeshopt) sizes.raw += padded(part.raw_bytes());
    }
  }
  return sizes;
}

void add_view(Json& json, const Part& part, bool compressed, Sizes& at) {
  json.text("{\"buffer\":").text(compressed ? "1" : "0").text(",\"byteOffset\":");
  json.number(compressed ? at.raw : at.stored);
  json.text(",\"byteLength\":").number(part.raw_bytes());
  if (!part.index) json.text(",\"byteStride\":").number(part.stride);
  if (compressed) {
    json.text(",\"extensions\":{\"EXT_meshopt_compression\":{\"buffer\":0,\"byteOffset\":");
    json.number(at.stored).text(",\"byteLength\":").number(part.bytes.size());
    json.text(",\"byteStride\":").number(part.stride).text(",\"count\":").number(part.count);
    json.text(part.index ? ",\"mode\":\"TRIANGLES\"}}" : ",\"mode\":\"ATTRIBUTES\"}}");
    at.raw += padded(part.raw_bytes());
  }
  json.text("}");
  at.stored += padded(part.bytes.size());
}

/// Adds three accessors (position, normal, index), one for each view of the tile. Omits what glTF
/// makes optional (bounds other than those of positions, targets of views), because JSON is every
/// sixth byte of a compressed tile.
void add_accessors(Json& json, const EncodedTile& tile, int first_view) {
  json.text("{\"bufferView\":").number(first_view);
  json.text(",\"componentType\":5122,\"type\":\"VEC3\",\"count\":").number(tile.vertices);
  json.text(",\"min\":").triple(tile.min).text(",\"max\":").triple(tile.max);
  json.text("},{\"bufferView\":").number(first_view + 1);
  json.text(",\"componentType\":5120,\"normalized\":true,\"type\":\"VEC3\",\"count\":");
  json.number(tile.vertices);
  json.text("},{\"bufferView\":").number(first_view + 2);
  json.text(",\"componentType\":").number(tile.wide_indices ? 5125 : 5123);
  json.text(",\"type\":\"SCALAR\",\"count\":").number(tile.indices).text("}");
}

void add_node(Json& json, const EncodedTile& tile, const TileRun& run, double step_mm,
              std::size_t mesh, bool with_digest) {
  json.text("{\"name\":\"t_").number(tile.tile.x).text("_").number(tile.tile.y);
  json.text("\",\"extras\":{\"tile\":[").number(tile.tile.x).text(",").number(tile.tile.y);
  json.text("],\"version\":").number(tile.version);
  if (tile.level > 0) json.text(",\"level\":").number(int{tile.level});
  if (run.columns > 1 || run.rows > 1) {
    json.text(",\"repeat\":[").number(run.columns).text(",").number(run.rows).text("]");
  }
  if (with_digest) json.text(",\"digest\":").digits(tile.digest);
  json.text("}");
  if (tile.vertices > 0) {
    json.text(",\"mesh\":").number(mesh);
    json.text(",\"translation\":").triple(tile.translation_mm);
    json.text(",\"scale\":").triple(std::array{step_mm, step_mm, step_mm});
  }
  json.text("}");
}

void add_meshes(Json& json, const std::vector<const EncodedTile*>& meshes, const Sizes& sizes) {
  const std::string_view extensions =
      sizes.raw > 0 ? "[\"KHR_mesh_quantization\",\"EXT_meshopt_compression\"]"
                    : "[\"KHR_mesh_quantization\"]";
  json.text(",\"extensionsUsed\":").text(extensions);
  json.text(",\"extensionsRequired\":").text(extensions);
  json.text(",\"buffers\":[{\"byteLength\":").number(sizes.stored).text("}");
  if (sizes.raw > 0) {
    json.text(",{\"byteLength\":").number(sizes.raw);
    json.text(",\"extensions\":{\"EXT_meshopt_compression\":{\"fallback\":true}}}");
  }
  json.text("],\"bufferViews\":[");
  bool first = true;
  Sizes at;
  for (const EncodedTile* tile : meshes) {
    const bool compressed = tile->compression == TileCompression::kMeshopt;
    for (const Part& part : parts_of(*tile)) add_view(json.next(first), part, compressed, at);
  }
  json.text("],\"accessors\":[");
  first = true;
  int view = 0;
  for (const EncodedTile* tile : meshes) {
    add_accessors(json.next(first), *tile, view);
    view += 3;
  }
  json.text("],\"meshes\":[");
  first = true;
  for (int accessor = 0; accessor < view; accessor += 3) {
    json.next(first).text("{\"primitives\":[{\"attributes\":{\"POSITION\":").number(accessor);
    json.text(",\"NORMAL\":").number(accessor + 1);
    json.text("},\"indices\":").number(accessor + 2).text("}]}");
  }
  json.text("]");
}

/// The tiles of a frame, with the nodes and meshes that represent them.
struct FrameTiles {
  std::span<const EncodedTile* const> tiles;
  std::vector<TileRun> runs;
  Meshes meshes;
  bool with_digests;
};

std::string make_json(const FrameTiles& frame, const Sizes& sizes, double step_mm,
                      std::uint64_t from, std::uint64_t to) {
  const auto& [tiles, runs, meshes, with_digests] = frame;
  Json json;
  json.text("{\"asset\":{\"version\":\"2.0\",\"generator\":\"Kerf\"},\"scene\":0,\"scenes\":[{");
  bool first = true;
  if (!tiles.empty()) {
    json.text("\"nodes\":[");
    for (std::size_t n = 0; n < runs.size(); ++n) json.next(first).number(n);
    json.text("],");
  }
  json.text("\"extras\":{\"from\":").number(from).text(",\"to\":").number(to).text("}}]");
  if (!tiles.empty()) {
    json.text(",\"nodes\":[");
    first = true;
    for (const TileRun& run : runs) {
      add_node(json.next(first), *tiles[run.first], run, step_mm, meshes.of_tile[run.first],
               with_digests);
    }
    json.text("]");
  }
  if (sizes.stored > 0) add_meshes(json, meshes.distinct, sizes);
  return json.text("}").take();
}

void append_word(std::vector<std::byte>& out, std::size_t value) {
  for (int n = 0; n < 4; ++n) out.push_back(static_cast<std::byte>(value >> (8 * n)));
}

}  // namespace

std::vector<std::byte> write_mesh_glb(std::span<const EncodedTile* const> tiles,
                                      const MeshQuantization& quantization, std::uint64_t from,
                                      std::uint64_t to, TileNodes nodes) {
  const bool with_digests = nodes == TileNodes::kVerified;
  FrameTiles frame{tiles, {}, meshes_of(tiles), with_digests};
  if (nodes != TileNodes::kSingle) {
    frame.runs = runs_of(tiles, quantization, with_digests);
  } else {
    for (std::size_t n = 0; n < tiles.size(); ++n) frame.runs.push_back({n});
  }
  const Meshes& meshes = frame.meshes;
  const Sizes sizes = sizes_of(meshes.distinct);
  std::string json = make_json(frame, sizes, quantization.step_mm, from, to);
  json.resize(padded(json.size()), ' ');
  const std::size_t total = 12 + 8 + json.size() + (sizes.stored > 0 ? 8 + sizes.stored : 0);
  std::vector<std::byte> out;
  out.reserve(total);
  append_word(out, 0x46546C67);  // "glTF"
  append_word(out, 2);
  append_word(out, total);
  append_word(out, json.size());
  append_word(out, 0x4E4F534A);  // "JSON"
  const auto text = std::as_bytes(std::span(json));
  out.insert(out.end(), text.begin(), text.end());
  if (sizes.stored == 0) return out;
  append_word(out, sizes.stored);
  append_word(out, 0x004E4942);  // "BIN"
  for (const EncodedTile* tile : meshes.distinct) {
    for (const Part& part : parts_of(*tile)) {
      out.insert(out.end(), part.bytes.begin(), part.bytes.end());
      out.resize(padded(out.size()));
    }
  }
  return out;
}

}  // namespace kerf
