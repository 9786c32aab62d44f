// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <nlohmann/json.hpp>

#include "server/formats/model/glb_group.h"
#include "server/formats/model/model_parts.h"

// Writes binary glTF 2.0. The JSON precedes the arrays and contains their lengths, so the arrays
// are spooled; tinygltf would hold all of them in memory and drops extensions of buffer views.

namespace kerf {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMetresPerMm = 0.001;
/// Quaternion x, y, z, w from Z-up to glTF's Y-up: -90 degrees about x.
constexpr double kHalfSqrt = 0.70710678118654752;
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;

constexpr std::uint64_t padded(std::uint64_t bytes) { return (bytes + 3) / 4 * 4; }

/// Builds the JSON of a model group by group.
class GlbDocument {
 public:
  explicit GlbDocument(const ModelOutput& output)
      : encoding_(output.request.encoding), lattice_(glb_lattice(output.source.size_mm())) {
    const std::string& title = output.request.title;
    Json extras{{"scene", title}};
    if (encoding_ != ModelEncoding::kFloat) extras["step_mm"] = lattice_.step_mm;
    json_["asset"] = {{"version", "2.0"}, {"generator", "Kerf"}, {"extras", extras}};
    json_["scene"] = 0;
    json_["scenes"] = {{{"name", title}, {"nodes", {0}}}};
    // Importers name their objects after the node and the mesh.
    json_["nodes"] = {{{"name", title.empty() ? "kerf" : title}}};
    place(json_["nodes"][0], output.origin_mm());
  }

  const GlbLattice& lattice() const { return lattice_; }

  /// Adds a primitive for a group whose arrays start at `offset` of the binary chunk, each padded
  /// to four bytes.
  void add(const std::vector<GlbArray>& arrays, std::uint64_t offset) {
    Json attributes;
    Json primitive{{"attributes", nullptr}};
    for (const GlbArray& array : arrays) {
      add_view(array, offset);
      offset += padded(array.bytes.size());
      Json accessor{{"bufferView", json_["bufferViews"].size() - 1},
                    {"componentType", array.component},
                    {"count", array.count},
                    {"type", array.type}};
      if (array.normalized) accessor["normalized"] = true;
      if (!array.min.empty()) {
        accessor["min"] = bounds(array, array.min);
        accessor["max"] = bounds(array, array.max);
      }
      if (array.name.empty()) {
        primitive["indices"] = json_["accessors"].size();
      } else {
        attributes[array.name] = json_["accessors"].size();
      }
      json_["accessors"].push_back(std::move(accessor));
      colored_ = colored_ || array.name == "COLOR_0";
    }
    primitive["attributes"] = std::move(attributes);
    primitive["material"] = 0;
    if (json_["meshes"].empty()) {
      json_["meshes"] = {{{"name", json_["nodes"][0]["name"]}, {"primitives", Json::array()}}};
      json_["nodes"][0]["mesh"] = 0;
    }
    json_["meshes"][0]["primitives"].push_back(std::move(primitive));
  }

  /// Returns the JSON text. `binary_bytes` is the length of the binary chunk's content.
  std::string text(std::uint64_t binary_bytes) {
    if (binary_bytes > 0) {
      // Vertex colors multiply the base color, which is therefore white.
      const Json color = colored_ ? Json{1.0, 1.0, 1.0, 1.0} : Json{0.72, 0.62, 0.48, 1.0};
      json_["materials"] = {
          {{"name", "stock"},
           {"pbrMetallicRoughness",
            {{"baseColorFactor", color}, {"metallicFactor", 0.0}, {"roughnessFactor", 0.6}}}}};
      json_["buffers"] = {{{"byteLength", binary_bytes}}};
      Json extensions;
      if (encoding_ != ModelEncoding::kFloat) extensions.push_back("KHR_mesh_quantization");
      if (encoding_ == ModelEncoding::kMeshopt) {
        extensions.push_back("EXT_meshopt_compression");
        json_["buffers"].push_back(
            {{"byteLength", unpacked_bytes_},
             {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}});
      }
      if (!extensions.empty()) {
        json_["extensionsUsed"] = extensions;
        json_["extensionsRequired"] = extensions;
      }
    }
    std::string text = json_.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.resize(padded(text.size()), ' ');
    return text;
  }

 private:
  static Json bounds(const GlbArray& array, const std::vector<double>& values) {
    Json list = Json::array();
    const bool whole = array.stride == 8;  // positions in steps
    for (const double v : values) whole ? list.push_back(static_cast<int>(v)) : list.push_back(v);
    return list;
  }

  void add_view(const GlbArray& array, std::uint64_t offset) {
    const bool is_index = array.name.empty();
    const std::uint64_t unpacked = array.count * array.stride;
    Json view{{"buffer", array.compressed ? 1 : 0},
              {"byteOffset", array.compressed ? unpacked_bytes_ : offset},
              {"byteLength", unpacked}};
    if (!is_index) view["byteStride"] = array.stride;
    view["target"] = is_index ? kElementArrayBuffer : kArrayBuffer;
    if (array.compressed) {
      view["extensions"]["EXT_meshopt_compression"] = {
          {"buffer", 0},
          {"byteOffset", offset},
          {"byteLength", array.bytes.size()},
          {"byteStride", array.stride},
          {"count", array.count},
          {"mode", is_index ? "TRIANGLES" : "ATTRIBUTES"}};
      unpacked_bytes_ += padded(unpacked);
    }
    json_["bufferViews"].push_back(std::move(view));
  }

  /// Positions are in mm, Z up, relative to the block's corner, so that floats stay precise far
  /// from the origin of the scene. Quantized ones are in steps from the middle of the lattice.
  void place(Json& node, Vec3 origin_mm) const {
    double unit_mm = 1;
    if (encoding_ != ModelEncoding::kFloat) {
      const double half = 32768 * lattice_.step_mm;
      origin_mm = origin_mm + Vec3{half, half, half};
      unit_mm = lattice_.step_mm;
    }
    const Vec3 o = origin_mm * kMetresPerMm;
    const double unit = unit_mm * kMetresPerMm;
    node["translation"] = {o.x, o.z, -o.y};
    node["rotation"] = {-kHalfSqrt, 0, 0, kHalfSqrt};
    node["scale"] = {unit, unit, unit};
  }

  ModelEncoding encoding_;
  GlbLattice lattice_;
  Json json_;
  std::uint64_t unpacked_bytes_ = 0;
  bool colored_ = false;
};

std::vector<std::byte> words(std::initializer_list<std::uint32_t> values) {
  std::vector<std::byte> bytes;
  for (const std::uint32_t value : values) put_u32(bytes, value);
  return bytes;
}

void spool_group(GlbGroup& group, GlbDocument& document, const ModelOutput& output,
                 SpoolFile& spool, ModelSummary& summary) {
  const std::vector<GlbArray> arrays = group.take(output.request.encoding, document.lattice());
  if (arrays.empty()) return;
  document.add(arrays, spool.bytes());
  for (const GlbArray& array : arrays) {
    spool.write(array.bytes);
    constexpr std::array<std::byte, 3> kPadding{};
    spool.write(std::span(kPadding).first(padded(array.bytes.size()) - array.bytes.size()));
  }
  summary.vertices += arrays.front().count;
  summary.triangles += arrays.back().count / 3;
}

}  // namespace

ModelResult write_glb(const ModelOutput& output) {
  GlbDocument document(output);
  SpoolFile spool(output.path);
  GlbGroup group;
  ModelSummary summary;
  MeshPiece piece;
  while (output.next(piece)) {
    if (group.is_full_for(piece)) spool_group(group, document, output, spool, summary);
    if (!piece.indices.empty()) group.add(piece);
  }
  if (!group.empty()) spool_group(group, document, output, spool, summary);

  const std::string json = document.text(spool.bytes());
  const std::uint64_t total = 12 + 8 + json.size() + (spool.bytes() > 0 ? 8 + spool.bytes() : 0);
  if (total > std::numeric_limits<std::uint32_t>::max()) {
    return model_error("the surface exceeds 4 GiB, the limit of GLB");
  }
  const auto low = [](std::uint64_t n) { return static_cast<std::uint32_t>(n); };
  output.sink.write(words({0x46546C67, 2, low(total), low(json.size()), 0x4E4F534A}));
  output.sink.write(json);
  if (spool.bytes() == 0) return summary;
  output.sink.write(words({low(spool.bytes()), 0x004E4942}));
  const bool whole = spool.read_all([&](std::span<const std::byte> c) { output.sink.write(c); });
  if (!whole) return model_error("writing the temporary file failed; is the disk full?");
  return summary;
}

}  // namespace kerf
