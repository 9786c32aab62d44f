// SPDX-License-Identifier: Apache-2.0
#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "server/formats/model/mesh_reader.h"
#include "server/formats/model/mesh_rejection.h"

// Reads binary glTF 2.0: the triangles of the nodes of its scene. Lengths are meters and +Y is up
// (glTF 2.0, 3.4): they become mm with +Z up. Materials, textures, skins and animations are
// ignored: what is read is the pose that the nodes state.

namespace kerf {
namespace {

constexpr int kNodeDepthMax = 64;
constexpr double kMmPerMeter = 1000;

/// Extensions that a file may require: they do not change where its triangles are, or as said.
constexpr std::array<std::string_view, 3> kExtensionsRead{
    "KHR_mesh_quantization", "KHR_texture_transform", "KHR_lights_punctual"};

bool is_read(std::string_view extension) {
  return extension.starts_with("KHR_materials_") ||
         std::ranges::find(kExtensionsRead, extension) != kExtensionsRead.end();
}

/// A 4 x 4 matrix by columns, as glTF writes it.
struct NodeMatrix {
  std::array<double, 16> m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

  Vec3 apply(Vec3 v) const {
    return {m[0] * v.x + m[4] * v.y + m[8] * v.z + m[12],
            m[1] * v.x + m[5] * v.y + m[9] * v.z + m[13],
            m[2] * v.x + m[6] * v.y + m[10] * v.z + m[14]};
  }
  Vec3 column(std::size_t n) const { return {m[4 * n], m[4 * n + 1], m[4 * n + 2]}; }
  bool mirrors() const { return dot(cross(column(0), column(1)), column(2)) < 0; }
  /// The other first, then this.
  NodeMatrix after(const NodeMatrix& other) const {
    NodeMatrix product;
    for (std::size_t c = 0; c < 4; ++c) {
      for (std::size_t r = 0; r < 4; ++r) {
        double sum = 0;
        for (std::size_t n = 0; n < 4; ++n) sum += m[4 * n + r] * other.m[4 * c + n];
        product.m[4 * c + r] = sum;
      }
    }
    return product;
  }
};

NodeMatrix matrix_of(const tinygltf::Node& node) {
  NodeMatrix matrix;
  if (node.matrix.size() == 16) {
    std::ranges::copy(node.matrix, matrix.m.begin());
    return matrix;
  }
  if (node.rotation.size() == 4) {
    const double x = node.rotation[0], y = node.rotation[1], z = node.rotation[2],
                 w = node.rotation[3];
    matrix.m = {1 - 2 * (y * y + z * z),
                2 * (x * y + z * w),
                2 * (x * z - y * w),
                0,
                2 * (x * y - z * w),
                1 - 2 * (x * x + z * z),
                2 * (y * z + x * w),
                0,
                2 * (x * z + y * w),
                2 * (y * z - x * w),
                1 - 2 * (x * x + y * y),
                0,
                0,
                0,
                0,
                1};
  }
  if (node.scale.size() == 3) {
    for (std::size_t n = 0; n < 12; ++n) matrix.m[n] *= node.scale[n / 4];
  }
  if (node.translation.size() == 3) std::ranges::copy(node.translation, matrix.m.begin() + 12);
  return matrix;
}

template <class Item>
const Item& item_of(const std::vector<Item>& list, int number, const char* what) {
  if (number < 0 || static_cast<std::size_t>(number) >= list.size())
    reject_mesh(MeshFileErrorCode::kBadIndex,
                std::string(what) + ' ' + std::to_string(number) + " does not exist");
  return list[static_cast<std::size_t>(number)];
}

/// The bytes of an accessor, element by element, checked against its buffer.
class Elements {
 public:
  Elements(const tinygltf::Model& model, int number) {
    const tinygltf::Accessor& accessor = item_of(model.accessors, number, "accessor");
    if (accessor.sparse.isSparse)
      reject_mesh(MeshFileErrorCode::kUnsupported, "sparse accessors are not read");
    const tinygltf::BufferView& view =
        item_of(model.bufferViews, accessor.bufferView, "bufferView");
    const tinygltf::Buffer& buffer = item_of(model.buffers, view.buffer, "buffer");
    type_ = accessor.componentType;
    normalized_ = accessor.normalized;
    count_ = accessor.count;
    const int component = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(type_));
    components_ = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
    const int stride = accessor.ByteStride(view);
    if (component <= 0 || components_ <= 0 || stride < component * components_)
      reject_mesh(MeshFileErrorCode::kSyntax,
                  "accessor " + std::to_string(number) + " has an unknown type or stride");
    stride_ = static_cast<std::size_t>(stride);
    const std::size_t size = static_cast<std::size_t>(component * components_);
    const std::size_t in_view =
        view.byteOffset <= buffer.data.size()
            ? std::min(view.byteLength, buffer.data.size() - view.byteOffset)
            : 0;
    const bool inside = count_ > 0 && accessor.byteOffset <= in_view &&
                        in_view - accessor.byteOffset >= size &&
                        (count_ - 1) <= (in_view - accessor.byteOffset - size) / stride_;
    if (!inside)
      reject_mesh(MeshFileErrorCode::kTruncated,
                  "accessor " + std::to_string(number) + " ends outside its buffer");
    data_ = buffer.data.data() + view.byteOffset + accessor.byteOffset;
  }

  std::size_t size() const { return count_; }
  int components() const { return components_; }
  bool is_index() const {
    return components_ == 1 && (type_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                                type_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
                                type_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT);
  }
  std::uint32_t index(std::size_t n) const { return static_cast<std::uint32_t>(value(n, 0)); }
  Vec3 position(std::size_t n) const { return {value(n, 0), value(n, 1), value(n, 2)}; }

 private:
  template <class T>
  double read(const unsigned char* from) const {
    T number;
    std::memcpy(&number, from, sizeof number);
    const auto plain = static_cast<double>(number);
    if (std::is_floating_point_v<T> || !normalized_) return plain;
    return std::max(plain / static_cast<double>(std::numeric_limits<T>::max()), -1.0);
  }
  double value(std::size_t n, std::size_t component) const {
    const unsigned char* from = data_ + n * stride_;
    switch (type_) {
      case TINYGLTF_COMPONENT_TYPE_BYTE:
        return read<std::int8_t>(from + component);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return read<std::uint8_t>(from + component);
      case TINYGLTF_COMPONENT_TYPE_SHORT:
        return read<std::int16_t>(from + 2 * component);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return read<std::uint16_t>(from + 2 * component);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return read<std::uint32_t>(from + 4 * component);
      case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return read<float>(from + 4 * component);
      default:
        reject_mesh(MeshFileErrorCode::kUnsupported, "a component type is not one of glTF 2.0");
    }
  }

  const unsigned char* data_ = nullptr;
  std::size_t count_ = 0, stride_ = 0;
  int type_ = 0, components_ = 0;
  bool normalized_ = false;
};

std::uint32_t word_at(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}
void put_word(std::string& text, std::size_t word) {
  for (int n = 0; n < 4; ++n) text += static_cast<char>(word >> (8 * n) & 0xffU);
}

/// Returns the file with what tells of triangles only: tinygltf trusts the places of pictures, and
/// would unpack them.
std::string triangles_only(std::span<const std::byte> bytes) {
  constexpr std::size_t kHeader = 12, kChunkHeader = 8;
  constexpr std::uint32_t kMagic = 0x46546c67, kJson = 0x4e4f534a;
  const std::size_t json_at = kHeader + kChunkHeader;
  if (bytes.size() < json_at || word_at(bytes, 0) != kMagic || word_at(bytes, 16) != kJson)
    reject_mesh(MeshFileErrorCode::kSyntax, "the file does not begin as binary glTF does");
  if (word_at(bytes, 4) != 2)
    reject_mesh(MeshFileErrorCode::kUnsupported, "the file is not of version 2 of glTF");
  const std::size_t json_size = word_at(bytes, kHeader);
  if (word_at(bytes, 8) > bytes.size() || json_size > bytes.size() - json_at)
    reject_mesh(MeshFileErrorCode::kTruncated, "the file is shorter than it says");
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()) + json_at, json_size);
  // What is nested deeper is dropped: the library writes JSON by recursion.
  constexpr int kDepthMax = 32;
  const auto all = nlohmann::json::parse(
      text,
      [](int depth, nlohmann::json::parse_event_t, nlohmann::json&) { return depth < kDepthMax; },
      false);
  if (!all.is_object()) reject_mesh(MeshFileErrorCode::kSyntax, "the JSON of the file is invalid");
  // tinygltf fails at what such an extension leaves out, without naming it.
  for (const auto& required : all.value("extensionsRequired", nlohmann::json::array())) {
    const std::string extension = required.is_string() ? required.get<std::string>() : "";
    if (!is_read(extension))
      reject_mesh(MeshFileErrorCode::kUnsupported,
                  "the file requires the extension " + extension + ", which is not read");
  }
  nlohmann::json kept = nlohmann::json::object();
  for (const char* key :
       {"asset", "scene", "scenes", "nodes", "meshes", "accessors", "bufferViews", "buffers"}) {
    if (const auto found = all.find(key); found != all.end()) kept[key] = *found;
  }
  std::string json = kept.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto rest = bytes.subspan(json_at + json_size);
  std::string file;
  for (const std::size_t word :
       {std::size_t{kMagic}, std::size_t{2}, json_at + json.size() + rest.size(), json.size(),
        std::size_t{kJson}})
    put_word(file, word);
  file += json;
  file.append(reinterpret_cast<const char*>(rest.data()), rest.size());
  return file;
}

/// A file names nothing outside itself.
tinygltf::FsCallbacks no_files() {
  return {[](const std::string&, void*) { return false; },
          [](const std::string& name, void*) { return name; },
          [](std::vector<unsigned char>*, std::string* error, const std::string& name, void*) {
            *error += "it names the file " + name + "; put all of it into one .glb";
            return false;
          },
          [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
            return false;
          },
          nullptr};
}

class GltfReader {
 public:
  GltfReader(std::span<const std::byte> bytes, std::uint64_t triangles_max)
      : triangles_max_(triangles_max) {
    const std::string file = triangles_only(bytes);
    std::string error, warning;
    tinygltf::TinyGLTF loader;
    loader.SetFsCallbacks(no_files());
    if (file.size() > std::numeric_limits<std::uint32_t>::max() ||
        !loader.LoadBinaryFromMemory(&model_, &error, &warning,
                                     reinterpret_cast<const unsigned char*>(file.data()),
                                     static_cast<unsigned>(file.size()))) {
      std::ranges::replace(error, '\n', ' ');
      reject_mesh(MeshFileErrorCode::kSyntax, "the file is not valid binary glTF: " + error);
    }
  }

  TriangleMesh read() {
    // glTF +Y up, meters -> +Z up, mm.
    NodeMatrix root;
    root.m = {kMmPerMeter, 0, 0, 0, 0, 0, kMmPerMeter, 0, 0, -kMmPerMeter, 0, 0, 0, 0, 0, 1};
    const int number = model_.defaultScene >= 0 ? model_.defaultScene : 0;
    for (const int node : item_of(model_.scenes, number, "scene").nodes) place(node, root, 0);
    if (mesh_.triangles.empty())
      reject_mesh(MeshFileErrorCode::kEmpty, "the scene of the file has no triangle");
    return std::move(mesh_);
  }

 private:
  void place(int number, const NodeMatrix& parent, int depth) {
    if (depth > kNodeDepthMax)
      reject_mesh(MeshFileErrorCode::kUnsupported, "nodes are nested more than 64 deep");
    if (++nodes_ > triangles_max_) reject_mesh(MeshFileErrorCode::kTooLarge, "too many nodes");
    const tinygltf::Node& node = item_of(model_.nodes, number, "node");
    const NodeMatrix matrix = parent.after(matrix_of(node));
    if (node.mesh >= 0) {
      for (const auto& primitive : item_of(model_.meshes, node.mesh, "mesh").primitives)
        add(primitive, matrix);
    }
    for (const int child : node.children) place(child, matrix, depth + 1);
  }

  void add(const tinygltf::Primitive& primitive, const NodeMatrix& matrix) {
    const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
    if (mode < TINYGLTF_MODE_TRIANGLES) return;  // points and lines
    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end()) return;
    const Elements positions(model_, position->second);
    if (positions.components() != 3)
      reject_mesh(MeshFileErrorCode::kSyntax, "POSITION must have three components");
    first_ = static_cast<std::uint32_t>(mesh_.vertices_mm.size());
    count_ = positions.size();
    if (mesh_.vertices_mm.size() + count_ > 3 * triangles_max_)
      reject_mesh(MeshFileErrorCode::kTooLarge, "the file has too many vertices");
    for (std::size_t n = 0; n < count_; ++n) {
      mesh_.vertices_mm.push_back(matrix.apply(positions.position(n)));
      if (!is_finite(mesh_.vertices_mm.back()))
        reject_mesh(MeshFileErrorCode::kNotFinite, "a coordinate is not finite");
    }
    mirrored_ = matrix.mirrors();
    if (primitive.indices < 0) {
      add_triangles(mode, count_, [](std::size_t n) { return static_cast<std::uint32_t>(n); });
      return;
    }
    const Elements indices(model_, primitive.indices);
    if (!indices.is_index())
      reject_mesh(MeshFileErrorCode::kSyntax, "indices must be unsigned integers");
    add_triangles(mode, indices.size(), [&](std::size_t n) { return indices.index(n); });
  }

  /// glTF 2.0, 3.7.2.1: triangles, strips and fans.
  template <class Index>
  void add_triangles(int mode, std::size_t count, Index&& index) {
    if (mode == TINYGLTF_MODE_TRIANGLES) {
      for (std::size_t n = 0; n + 2 < count; n += 3)
        add_triangle(index(n), index(n + 1), index(n + 2));
      return;
    }
    for (std::size_t n = 0; n + 2 < count; ++n) {
      if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
        add_triangle(index(n + 1), index(n + 2), index(0));
      } else {
        add_triangle(index(n), index(n + 1 + n % 2), index(n + 2 - n % 2));
      }
    }
  }

  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (std::max({a, b, c}) >= count_)
      reject_mesh(MeshFileErrorCode::kBadIndex, "vertex " + std::to_string(std::max({a, b, c})) +
                                                    " is out of range: the " + "primitive has " +
                                                    std::to_string(count_));
    if (mesh_.triangles.size() == triangles_max_)
      reject_mesh(
          MeshFileErrorCode::kTooLarge,
          "the file has more than " + std::to_string(triangles_max_) + " triangles, the limit");
    if (mirrored_) std::swap(b, c);
    mesh_.triangles.push_back({first_ + a, first_ + b, first_ + c});
  }

  std::uint64_t triangles_max_, nodes_ = 0;
  tinygltf::Model model_;
  TriangleMesh mesh_;
  std::uint32_t first_ = 0;  ///< vertex of the current primitive
  std::size_t count_ = 0;
  bool mirrored_ = false;
};

}  // namespace

MeshFileResult read_gltf(std::span<const std::byte> bytes, std::uint64_t triangles_max) {
  try {
    return GltfReader(bytes, triangles_max).read();
  } catch (const MeshRejection& rejection) {
    return std::unexpected(rejection.error);
  }
}

}  // namespace kerf
