#pragma once

#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "kernel/dexel/tile_index.h"
#include "kernel/math/vec3.h"

namespace kerf::test {

inline tinygltf::Model load_glb(const std::vector<std::byte>& glb) {
  tinygltf::Model model;
  std::string error, warning;
  const bool ok = tinygltf::TinyGLTF().LoadBinaryFromMemory(
      &model, &error, &warning, reinterpret_cast<const unsigned char*>(glb.data()),
      static_cast<unsigned>(glb.size()));
  EXPECT_TRUE(ok) << error;
  EXPECT_TRUE(warning.empty()) << warning;
  return model;
}

/// A tile as a viewer sees it: in the world, mm.
struct DecodedTile {
  std::uint64_t version = 0;
  std::vector<Vec3> positions_mm, normals;
  std::vector<std::uint32_t> indices;
};
struct DecodedFrame {
  std::uint64_t from = 0, to = 0;
  std::map<TileIndex, DecodedTile> tiles;
};

template <typename T>
Vec3 vector_at(const tinygltf::Model& model, const tinygltf::Accessor& accessor, std::size_t n) {
  const tinygltf::BufferView& view = model.bufferViews.at(std::size_t(accessor.bufferView));
  const std::size_t at =
      view.byteOffset + accessor.byteOffset + n * std::size_t(accessor.ByteStride(view));
  std::array<T, 3> v{};
  std::memcpy(v.data(), model.buffers.at(0).data.data() + at, sizeof v);
  return {double(v[0]), double(v[1]), double(v[2])};
}

inline std::uint32_t index_at(const tinygltf::Model& model, const tinygltf::Accessor& accessor,
                              std::size_t n) {
  const bool wide = accessor.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
  const std::size_t width = wide ? 4 : 2;
  const tinygltf::BufferView& view = model.bufferViews.at(std::size_t(accessor.bufferView));
  std::uint32_t index = 0;
  std::memcpy(&index,
              model.buffers.at(0).data.data() + view.byteOffset + accessor.byteOffset + n * width,
              width);
  return index;
}

/// Reads a mesh frame through a library that shares no code with its writer.
inline DecodedFrame read_mesh_glb(const std::vector<std::byte>& glb) {
  const tinygltf::Model model = load_glb(glb);
  DecodedFrame frame;
  const tinygltf::Value& extras = model.scenes.at(0).extras;
  frame.from = std::uint64_t(extras.Get("from").GetNumberAsInt());
  frame.to = std::uint64_t(extras.Get("to").GetNumberAsInt());
  for (const tinygltf::Node& node : model.nodes) {
    const tinygltf::Value& tile = node.extras.Get("tile");
    const TileIndex index{tile.Get(0).GetNumberAsInt(), tile.Get(1).GetNumberAsInt()};
    EXPECT_EQ(node.name, "t_" + std::to_string(index.x) + "_" + std::to_string(index.y));
    DecodedTile& out = frame.tiles[index];
    out.version = std::uint64_t(node.extras.Get("version").GetNumberAsInt());
    if (node.mesh < 0) continue;
    const tinygltf::Primitive& primitive = model.meshes.at(std::size_t(node.mesh)).primitives.at(0);
    const auto& position = model.accessors.at(std::size_t(primitive.attributes.at("POSITION")));
    const auto& normal = model.accessors.at(std::size_t(primitive.attributes.at("NORMAL")));
    const auto& indices = model.accessors.at(std::size_t(primitive.indices));
    const Vec3 at{node.translation[0], node.translation[1], node.translation[2]};
    for (std::size_t n = 0; n < position.count; ++n) {
      out.positions_mm.push_back(at + vector_at<std::int16_t>(model, position, n) * node.scale[0]);
      out.normals.push_back(vector_at<std::int8_t>(model, normal, n) * (1.0 / 127));
    }
    for (std::size_t n = 0; n < indices.count; ++n) {
      out.indices.push_back(index_at(model, indices, n));
    }
  }
  return frame;
}

}  // namespace kerf::test
