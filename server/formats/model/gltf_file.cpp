// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/gltf_file.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "server/formats/bounded_json.h"
#include "server/formats/model/mesh_rejection.h"

namespace kerf {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kHeader = 12, kChunkHeader = 8;
constexpr std::uint32_t kMagic = 0x46546c67, kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;
constexpr const char* kMeshopt = "EXT_meshopt_compression";
/// Densest code of the vertex codec: 256 constant bytes take four.
constexpr std::size_t kUnpackedShareMax = 64;

/// Extensions that a file may require, because they do not affect its triangles or are read.
constexpr std::array<std::string_view, 4> kExtensionsRead{
    "KHR_mesh_quantization", "KHR_texture_transform", "KHR_lights_punctual", kMeshopt};

bool is_read(std::string_view extension) {
  return extension.starts_with("KHR_materials_") ||
         std::ranges::find(kExtensionsRead, extension) != kExtensionsRead.end();
}

std::uint32_t word_at(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}
void put_word(std::string& text, std::size_t word) {
  for (int n = 0; n < 4; ++n) text += static_cast<char>(word >> (8 * n) & 0xffU);
}

/// Returns a whole number of an object, or nullopt.
std::optional<std::size_t> number_of(const Json& object, const char* key) {
  if (!object.is_object()) return std::nullopt;
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number_unsigned()) return std::nullopt;
  return found->get<std::size_t>();
}
/// Returns a member of an object or an element of a list, or null.
const Json& at(const Json& object, const char* key) {
  static const Json kNone;
  const auto found = object.is_object() ? object.find(key) : object.end();
  return object.is_object() && found != object.end() ? *found : kNone;
}
const Json& item_at(const Json& list, std::optional<std::size_t> number) {
  static const Json kNone;
  return list.is_array() && number && *number < list.size() ? list[*number] : kNone;
}

/// Unpacks views in the JSON of a file.
class MeshoptViews {
 public:
  MeshoptViews(Json& json, std::span<const std::byte> binary, const std::stop_token& stop)
      : json_(json),
        binary_(binary),
        unpacked_max_(kUnpackedShareMax * binary.size()),
        stop_(stop) {}

  /// Returns the bytes to append to the binary chunk. The JSON refers to them.
  std::string unpack() {
    for (const std::size_t view : views_needed()) {
      if (stop_.stop_requested()) reject_mesh(MeshFileErrorCode::kStopped, "stopped");
      const Json extension =
          at(at(item_at(at(json_, "bufferViews"), view), "extensions"), kMeshopt);
      if (extension.is_object()) unpack(view, extension);
    }
    if (unpacked_.empty()) return {};
    if (!item_at(at(json_, "buffers"), 0).is_object())
      reject_mesh(MeshFileErrorCode::kSyntax, "the file has no buffer");
    // A fallback buffer for unpacked bytes has no bytes in the file.
    for (Json& buffer : json_["buffers"]) {
      if (at(at(at(buffer, "extensions"), kMeshopt), "fallback") == true) buffer["byteLength"] = 1;
    }
    json_["buffers"][0]["byteLength"] = start() + unpacked_.size();
    return std::move(unpacked_);
  }

 private:
  /// Offset of the unpacked bytes: the binary chunk is padded to four bytes.
  std::size_t start() const { return (binary_.size() + 3) / 4 * 4; }

  /// The views of positions and indices.
  std::set<std::size_t> views_needed() const {
    std::set<std::size_t> views;
    const auto need = [&views](const Json& accessor) {
      if (const auto view = number_of(accessor, "bufferView")) views.insert(*view);
    };
    const Json& accessors = at(json_, "accessors");
    for (const Json& mesh : at(json_, "meshes")) {
      for (const Json& primitive : at(mesh, "primitives")) {
        need(item_at(accessors, number_of(at(primitive, "attributes"), "POSITION")));
        need(item_at(accessors, number_of(primitive, "indices")));
      }
    }
    return views;
  }

  [[noreturn]] static void reject(std::size_t view, const std::string& reason) {
    reject_mesh(MeshFileErrorCode::kSyntax,
                "bufferView " + std::to_string(view) + " (" + kMeshopt + "): " + reason);
  }

  void unpack(std::size_t view, const Json& extension) {
    const auto stride = number_of(extension, "byteStride"), count = number_of(extension, "count"),
               length = number_of(extension, "byteLength");
    const std::size_t offset = number_of(extension, "byteOffset").value_or(0);
    if (!stride || !count || !length || number_of(extension, "buffer") != std::size_t{0})
      reject(view, "its buffer must be 0, with byteLength, byteStride and count");
    if (offset > binary_.size() || *length > binary_.size() - offset)
      reject(view, "it ends outside its buffer");
    const Json& stated = at(extension, "mode");
    const std::string mode = stated.is_string() ? stated.get<std::string>() : "";
    const bool vertices = mode == "ATTRIBUTES";
    const bool valid = vertices ? *stride >= 4 && *stride <= 256 && *stride % 4 == 0
                                : *stride == 2 || *stride == 4;
    if (!valid) reject(view, "its byteStride is invalid");
    if (*count == 0 || *count > unpacked_max_ / *stride ||
        unpacked_.size() + *count * *stride > unpacked_max_)
      reject(view, "it states more elements than its bytes can hold");
    std::vector<char> out(*count * *stride);
    if (!decode(mode, out, *count, *stride,
                {reinterpret_cast<const unsigned char*>(binary_.data()) + offset, *length}))
      reject(view, "its compressed data are invalid");
    if (const Json& filter = at(extension, "filter"); filter == "EXPONENTIAL" && vertices)
      meshopt_decodeFilterExp(out.data(), *count, *stride);
    else if (!filter.is_null() && filter != "NONE")
      reject(view, "positions and indices have no filter but EXPONENTIAL");
    Json& made = json_["bufferViews"][view];
    made["buffer"] = 0;
    made["byteOffset"] = start() + unpacked_.size();
    made["byteLength"] = out.size();
    unpacked_.append(out.begin(), out.end());
    unpacked_.resize((unpacked_.size() + 3) / 4 * 4);
  }

  static bool decode(const std::string& mode, std::vector<char>& out, std::size_t count,
                     std::size_t stride, std::span<const unsigned char> from) {
    if (mode == "ATTRIBUTES")
      return meshopt_decodeVertexBuffer(out.data(), count, stride, from.data(), from.size()) == 0;
    if (mode == "TRIANGLES")
      return count % 3 == 0 &&
             meshopt_decodeIndexBuffer(out.data(), count, stride, from.data(), from.size()) == 0;
    return mode == "INDICES" &&
           meshopt_decodeIndexSequence(out.data(), count, stride, from.data(), from.size()) == 0;
  }

  Json& json_;
  std::span<const std::byte> binary_;
  std::size_t unpacked_max_;
  const std::stop_token& stop_;
  std::string unpacked_;
};

/// Limits for hostile files: an item takes three bytes in the file and some hundred in memory.
constexpr std::size_t kItemsMax = 250'000, kValuesMax = 4'000'000;

[[noreturn]] void reject_json(JsonFaultKind kind) {
  if (kind == JsonFaultKind::kStopped) reject_mesh(MeshFileErrorCode::kStopped, "stopped");
  if (kind == JsonFaultKind::kTooMany)
    reject_mesh(
        MeshFileErrorCode::kTooLarge,
        "the JSON of the file has more than " + std::to_string(kValuesMax) + " values, the limit");
  reject_mesh(MeshFileErrorCode::kSyntax, "the JSON of the file is invalid");
}

/// Returns the JSON of a file, reduced to its triangles.
Json geometry_json(std::string_view text, const std::stop_token& stop) {
  // Deeper values are dropped, because the library writes JSON by recursion.
  constexpr int kDepthMax = 32;
  const auto parsed =
      parse_bounded_json(text, {.depth_max = kDepthMax,
                                .drops_deeper = true,
                                .takes_repeated_keys = true,
                                .values_max = kValuesMax,
                                .is_stopped = [&stop] { return stop.stop_requested(); }});
  if (!parsed) reject_json(parsed.error().kind);
  Json& all = *static_cast<Json*>(parsed->get());
  if (!all.is_object()) reject_json(JsonFaultKind::kSyntax);
  // tinygltf fails without naming such an extension.
  for (const auto& required : at(all, "extensionsRequired")) {
    const std::string extension = required.is_string() ? required.get<std::string>() : "";
    if (!is_read(extension))
      reject_mesh(MeshFileErrorCode::kUnsupported,
                  "the file requires the extension " + extension + ", which is not read");
  }
  Json kept = Json::object();
  for (const char* key :
       {"asset", "scene", "scenes", "nodes", "meshes", "accessors", "bufferViews", "buffers"}) {
    const auto found = all.find(key);
    if (found == all.end()) continue;
    if (found->is_array() && found->size() > kItemsMax)
      reject_mesh(MeshFileErrorCode::kTooLarge, std::string("the file has ") +
                                                    std::to_string(found->size()) + " " + key +
                                                    "; the limit is " + std::to_string(kItemsMax));
    kept[key] = std::move(*found);
  }
  return kept;
}

/// The content of the binary chunk, or empty without one.
std::span<const std::byte> binary_chunk(std::span<const std::byte> rest) {
  if (rest.size() < kChunkHeader || word_at(rest, 4) != kBinaryChunk) return {};
  const auto content = rest.subspan(kChunkHeader);
  return content.first(std::min<std::size_t>(word_at(rest, 0), content.size()));
}

}  // namespace

std::string gltf_geometry(std::span<const std::byte> bytes, const std::stop_token& stop) {
  const std::size_t json_at = kHeader + kChunkHeader;
  if (bytes.size() < json_at || word_at(bytes, 0) != kMagic || word_at(bytes, 16) != kJsonChunk)
    reject_mesh(MeshFileErrorCode::kSyntax, "the file does not begin as binary glTF does");
  if (word_at(bytes, 4) != 2)
    reject_mesh(MeshFileErrorCode::kUnsupported, "the file is not of version 2 of glTF");
  const std::size_t json_size = word_at(bytes, kHeader);
  if (word_at(bytes, 8) > bytes.size() || json_size > bytes.size() - json_at)
    reject_mesh(MeshFileErrorCode::kTruncated, "the file is shorter than it says");
  Json json =
      geometry_json({reinterpret_cast<const char*>(bytes.data()) + json_at, json_size}, stop);
  const auto binary = binary_chunk(bytes.subspan(json_at + json_size));
  const std::string unpacked = MeshoptViews(json, binary, stop).unpack();
  std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.resize((text.size() + 3) / 4 * 4, ' ');
  const std::size_t binary_size = (binary.size() + 3) / 4 * 4 + unpacked.size();
  const std::size_t size =
      json_at + text.size() + (binary_size > 0 ? kChunkHeader + binary_size : 0);
  if (size > UINT32_MAX)
    reject_mesh(MeshFileErrorCode::kTooLarge, "the file has more than 4 GiB of geometry");
  std::string file;
  file.reserve(size);
  for (const std::size_t word :
       {std::size_t{kMagic}, std::size_t{2}, size, text.size(), std::size_t{kJsonChunk}})
    put_word(file, word);
  file += text;
  if (binary_size == 0) return file;
  put_word(file, binary_size);
  put_word(file, kBinaryChunk);
  file.append(reinterpret_cast<const char*>(binary.data()), binary.size());
  file.resize(file.size() + (4 - binary.size() % 4) % 4);
  return file += unpacked;
}

}  // namespace kerf
