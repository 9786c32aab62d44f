#include "server/feed/mesh_glb.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string_view>

namespace kerf {
namespace {

/// Steps that a tile may span: below 65536, so that rounding at both ends still fits.
constexpr double kStepsMax = 65000;
/// Finer than this share of the pitch, more bits would only carry noise.
constexpr double kStepMinPitches = 1.0 / 4096;
/// Pitches that a tile's vertices may span: its columns and half a cell on each side, and some.
constexpr int kTileSpanPitches = kTileSide + 2;
constexpr std::size_t kPositionBytes = 8, kNormalBytes = 4;
constexpr std::uint32_t kShortIndexVerticesMax = 65535;

template <typename T>
void put(std::byte* at, T value) {
  static_assert(std::endian::native == std::endian::little);
  std::memcpy(at, &value, sizeof(T));
}

std::size_t padded(std::size_t bytes) { return (bytes + 3) / 4 * 4; }

std::int64_t to_steps(double mm, double step_mm) {
  return static_cast<std::int64_t>(std::floor(mm / step_mm + 0.5));
}

/// JSON, written from front to back.
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
  /// A comma before every element but the first.
  Json& next(bool& first) {
    if (!first) out_.push_back(',');
    first = false;
    return *this;
  }
  const std::string& str() const { return out_; }

 private:
  std::string out_;
};

/// Where the bytes of all tiles stand in the binary chunk: one view for positions, one for normals,
/// and one for each width of index, so that a tile costs three accessors and no view.
struct Layout {
  std::size_t positions = 0, normals = 0, shorts = 0, words = 0;
  std::size_t total() const { return positions + normals + shorts + words; }
};

Layout layout_of(std::span<const EncodedTile* const> tiles) {
  Layout layout;
  for (const EncodedTile* tile : tiles) {
    layout.positions += tile->positions.size();
    layout.normals += tile->normals.size();
    (tile->wide_indices ? layout.words : layout.shorts) += tile->index_bytes.size();
  }
  return layout;
}

void add_view(Json& json, bool& first, std::size_t offset, std::size_t length,
              std::string_view rest) {
  json.next(first).text("{\"buffer\":0,\"byteOffset\":").number(offset);
  json.text(",\"byteLength\":").number(length).text(rest).text("}");
}

void add_views(Json& json, const Layout& layout) {
  bool first = true;
  json.text(",\"bufferViews\":[");
  add_view(json, first, 0, layout.positions, ",\"byteStride\":8,\"target\":34962");
  add_view(json, first, layout.positions, layout.normals, ",\"byteStride\":4,\"target\":34962");
  const std::size_t indices = layout.positions + layout.normals;
  if (layout.shorts > 0) add_view(json, first, indices, layout.shorts, ",\"target\":34963");
  if (layout.words > 0) {
    add_view(json, first, indices + layout.shorts, layout.words, ",\"target\":34963");
  }
  json.text("]");
}

struct Offsets {
  std::size_t position = 0, normal = 0, short_index = 0, word_index = 0;
};

void add_accessors(Json& json, bool& first, const EncodedTile& tile, const Layout& layout,
                   Offsets& at) {
  json.next(first).text("{\"bufferView\":0,\"byteOffset\":").number(at.position);
  json.text(",\"componentType\":5122,\"type\":\"VEC3\",\"count\":").number(tile.vertices);
  json.text(",\"min\":").triple(tile.min).text(",\"max\":").triple(tile.max);
  json.text("},{\"bufferView\":1,\"byteOffset\":").number(at.normal);
  json.text(",\"componentType\":5120,\"normalized\":true,\"type\":\"VEC3\",\"count\":");
  json.number(tile.vertices);
  json.text(",\"min\":").triple(tile.normal_min).text(",\"max\":").triple(tile.normal_max);
  std::size_t& index_at = tile.wide_indices ? at.word_index : at.short_index;
  const int view = tile.wide_indices && layout.shorts > 0 ? 3 : 2;
  json.text("},{\"bufferView\":").number(view).text(",\"byteOffset\":").number(index_at);
  json.text(",\"componentType\":").number(tile.wide_indices ? 5125 : 5123);
  json.text(",\"type\":\"SCALAR\",\"count\":").number(tile.indices);
  json.text(",\"min\":[0],\"max\":[").number(tile.vertices - 1).text("]}");
  at.position += tile.positions.size();
  at.normal += tile.normals.size();
  index_at += tile.index_bytes.size();
}

void add_node(Json& json, bool& first, const EncodedTile& tile, double step_mm, int mesh) {
  json.next(first).text("{\"name\":\"t_").number(tile.tile.x).text("_").number(tile.tile.y);
  json.text("\",\"extras\":{\"tile\":[").number(tile.tile.x).text(",").number(tile.tile.y);
  json.text("],\"version\":").number(tile.version).text("}");
  if (tile.vertices > 0) {
    json.text(",\"mesh\":").number(mesh);
    json.text(",\"translation\":").triple(tile.translation_mm);
    json.text(",\"scale\":").triple(std::array{step_mm, step_mm, step_mm});
  }
  json.text("}");
}

void add_meshes(Json& json, std::span<const EncodedTile* const> tiles, const Layout& layout) {
  json.text(",\"extensionsUsed\":[\"KHR_mesh_quantization\"]");
  json.text(",\"extensionsRequired\":[\"KHR_mesh_quantization\"]");
  json.text(",\"buffers\":[{\"byteLength\":").number(layout.total()).text("}]");
  add_views(json, layout);
  bool first = true;
  Offsets at;
  json.text(",\"accessors\":[");
  for (const EncodedTile* tile : tiles) {
    if (tile->vertices > 0) add_accessors(json, first, *tile, layout, at);
  }
  first = true;
  int accessor = 0;
  json.text("],\"meshes\":[");
  for (const EncodedTile* tile : tiles) {
    if (tile->vertices == 0) continue;
    json.next(first).text("{\"primitives\":[{\"attributes\":{\"POSITION\":").number(accessor);
    json.text(",\"NORMAL\":").number(accessor + 1);
    json.text("},\"indices\":").number(accessor + 2).text("}]}");
    accessor += 3;
  }
  json.text("]");
}

std::string make_json(std::span<const EncodedTile* const> tiles, const Layout& layout,
                      double step_mm, std::uint64_t from, std::uint64_t to) {
  Json json;
  json.text("{\"asset\":{\"version\":\"2.0\",\"generator\":\"Kerf\"},\"scene\":0,\"scenes\":[{");
  if (!tiles.empty()) {
    json.text("\"nodes\":[");
    bool first = true;
    for (std::size_t n = 0; n < tiles.size(); ++n) json.next(first).number(n);
    json.text("],");
  }
  json.text("\"extras\":{\"from\":").number(from).text(",\"to\":").number(to).text("}}]");
  if (!tiles.empty()) {
    json.text(",\"nodes\":[");
    bool first = true;
    int mesh = 0;
    for (const EncodedTile* tile : tiles) {
      add_node(json, first, *tile, step_mm, mesh);
      mesh += tile->vertices > 0 ? 1 : 0;
    }
    json.text("]");
  }
  if (layout.total() > 0) add_meshes(json, tiles, layout);
  return json.text("}").str();
}

void append_word(std::vector<std::byte>& out, std::size_t value) {
  out.resize(out.size() + 4);
  put(out.data() + out.size() - 4, static_cast<std::uint32_t>(value));
}

void append(std::vector<std::byte>& out, std::span<const std::byte> bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
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

bool EncodedTile::same_surface(const EncodedTile& other) const {
  return vertices == other.vertices && indices == other.indices &&
         translation_mm == other.translation_mm && positions == other.positions &&
         normals == other.normals && index_bytes == other.index_bytes;
}

EncodedTile encode_tile(const TileMesh& mesh, const MeshQuantization& quantization,
                        std::uint32_t version) {
  EncodedTile out;
  out.tile = mesh.tile;
  out.version = version;
  if (mesh.indices.empty()) return out;
  const double step = quantization.step_mm;
  const std::size_t vertices = mesh.positions_mm.size();
  out.vertices = static_cast<std::uint32_t>(vertices);
  out.indices = static_cast<std::uint32_t>(mesh.indices.size());

  std::vector<std::array<std::int64_t, 3>> steps(vertices);
  std::array<std::int64_t, 3> low{INT64_MAX, INT64_MAX, INT64_MAX};
  std::array<std::int64_t, 3> high{INT64_MIN, INT64_MIN, INT64_MIN};
  for (std::size_t v = 0; v < vertices; ++v) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto value = static_cast<double>(mesh.positions_mm[v][axis]);
      steps[v][axis] = to_steps(value, step);
      low[axis] = std::min(low[axis], steps[v][axis]);
      high[axis] = std::max(high[axis], steps[v][axis]);
    }
  }
  std::array<std::int64_t, 3> center{};
  const std::array<double, 3> origin{quantization.origin_mm.x, quantization.origin_mm.y,
                                     quantization.origin_mm.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    center[axis] = (low[axis] + high[axis] + 1) / 2;
    out.translation_mm[axis] = origin[axis] + static_cast<double>(center[axis]) * step;
    out.min[axis] = static_cast<std::int16_t>(low[axis] - center[axis]);
    out.max[axis] = static_cast<std::int16_t>(high[axis] - center[axis]);
  }

  out.positions.resize(vertices * kPositionBytes);
  out.normals.resize(vertices * kNormalBytes);
  out.normal_min.fill(127);
  out.normal_max.fill(-127);
  for (std::size_t v = 0; v < vertices; ++v) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      put(out.positions.data() + v * kPositionBytes + 2 * axis,
          static_cast<std::int16_t>(steps[v][axis] - center[axis]));
      const auto normal = static_cast<std::int8_t>(std::lround(mesh.normals[v][axis] * 127.0F));
      put(out.normals.data() + v * kNormalBytes + axis, normal);
      out.normal_min[axis] = std::min(out.normal_min[axis], normal);
      out.normal_max[axis] = std::max(out.normal_max[axis], normal);
    }
  }
  out.wide_indices = vertices > kShortIndexVerticesMax;
  const std::size_t width = out.wide_indices ? 4 : 2;
  out.index_bytes.resize(padded(mesh.indices.size() * width));
  for (std::size_t n = 0; n < mesh.indices.size(); ++n) {
    std::byte* at = out.index_bytes.data() + n * width;
    if (out.wide_indices) {
      put(at, mesh.indices[n]);
    } else {
      put(at, static_cast<std::uint16_t>(mesh.indices[n]));
    }
  }
  return out;
}

std::vector<std::byte> write_mesh_glb(std::span<const EncodedTile* const> tiles,
                                      const MeshQuantization& quantization, std::uint64_t from,
                                      std::uint64_t to) {
  const Layout layout = layout_of(tiles);
  std::string json = make_json(tiles, layout, quantization.step_mm, from, to);
  json.resize(padded(json.size()), ' ');
  const std::size_t binary = layout.total();  // every part is padded to 4 already
  const std::size_t total = 12 + 8 + json.size() + (binary > 0 ? 8 + binary : 0);
  std::vector<std::byte> out;
  out.reserve(total);
  append_word(out, 0x46546C67);  // "glTF"
  append_word(out, 2);
  append_word(out, total);
  append_word(out, json.size());
  append_word(out, 0x4E4F534A);  // "JSON"
  append(out, std::as_bytes(std::span(json)));
  if (binary == 0) return out;
  append_word(out, binary);
  append_word(out, 0x004E4942);  // "BIN"
  for (const EncodedTile* tile : tiles) append(out, tile->positions);
  for (const EncodedTile* tile : tiles) append(out, tile->normals);
  for (const bool wide : {false, true}) {
    for (const EncodedTile* tile : tiles) {
      if (tile->wide_indices == wide) append(out, tile->index_bytes);
    }
  }
  return out;
}

}  // namespace kerf
