// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <meshoptimizer.h>

#include <nlohmann/json.hpp>

#include "kernel/dexel/tile_index.h"
#include "kernel/math/vec3.h"
#include "tests/support/test.h"

namespace kerf::test {

/// A tile as a viewer decodes it, in world coordinates (mm).
struct DecodedTile {
  std::uint64_t version = 0;
  int level = 0;
  std::vector<Vec3> positions_mm, normals;
  std::vector<std::uint32_t> indices;
  std::vector<std::uint8_t> original;  ///< the fourth bytes of the normals
  std::uint64_t digest = 0;            ///< 0 if not stated
};
struct DecodedFrame {
  std::uint64_t from = 0, to = 0;
  std::map<TileIndex, DecodedTile> tiles;
  std::size_t nodes = 0;
};

/// The parts of a GLB.
struct GlbParts {
  nlohmann::json json;
  std::vector<std::byte> binary;
};
inline GlbParts split_glb(const std::vector<std::byte>& glb) {
  const auto word = [&glb](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, glb.data() + at, 4);
    return value;
  };
  EXPECT_EQ(word(0), 0x46546C67U);
  EXPECT_EQ(word(8), glb.size());
  const std::size_t json_bytes = word(12);
  const auto* text = reinterpret_cast<const char*>(glb.data()) + 20;
  GlbParts parts{nlohmann::json::parse(text, text + json_bytes), {}};
  const std::size_t binary_at = 20 + json_bytes + 8;
  if (glb.size() > binary_at) parts.binary.assign(glb.begin() + long(binary_at), glb.end());
  return parts;
}

/// Returns the uncompressed bytes of a buffer view.
inline std::vector<std::byte> view_bytes(const GlbParts& glb, const nlohmann::json& view) {
  std::vector<std::byte> out(view.at("byteLength").get<std::size_t>());
  if (!view.contains("extensions")) {
    std::memcpy(out.data(), glb.binary.data() + view.at("byteOffset").get<std::size_t>(),
                out.size());
    return out;
  }
  const nlohmann::json& packed = view.at("extensions").at("EXT_meshopt_compression");
  const auto* from = reinterpret_cast<const unsigned char*>(glb.binary.data()) +
                     packed.at("byteOffset").get<std::size_t>();
  const auto bytes = packed.at("byteLength").get<std::size_t>();
  const auto count = packed.at("count").get<std::size_t>();
  const auto stride = packed.at("byteStride").get<std::size_t>();
  EXPECT_EQ(count * stride, out.size());
  const int failed = packed.at("mode") == "TRIANGLES"
                         ? meshopt_decodeIndexBuffer(out.data(), count, stride, from, bytes)
                         : meshopt_decodeVertexBuffer(out.data(), count, stride, from, bytes);
  EXPECT_EQ(failed, 0);
  return out;
}

template <typename T, std::size_t N>
std::array<T, N> element(const std::vector<std::byte>& bytes, std::size_t stride, std::size_t n) {
  std::array<T, N> out{};
  std::memcpy(out.data(), bytes.data() + n * stride, sizeof out);
  return out;
}

inline void decode_mesh(const GlbParts& glb, const nlohmann::json& node, DecodedTile& out) {
  const auto& primitive = glb.json["meshes"].at(node["mesh"].get<std::size_t>())["primitives"][0];
  const auto accessor = [&](const nlohmann::json& number) {
    return glb.json["accessors"].at(number.get<std::size_t>());
  };
  const auto bytes_of = [&](const nlohmann::json& a) {
    return view_bytes(glb, glb.json["bufferViews"].at(a["bufferView"].get<std::size_t>()));
  };
  const auto position = accessor(primitive["attributes"]["POSITION"]);
  const auto positions = bytes_of(position);
  const auto normals = bytes_of(accessor(primitive["attributes"]["NORMAL"]));
  const auto at = node["translation"].get<std::array<double, 3>>();
  const double scale = node["scale"][0].get<double>();
  for (std::size_t n = 0; n < position["count"].get<std::size_t>(); ++n) {
    const auto p = element<std::int16_t, 3>(positions, 8, n);
    const auto q = element<std::int8_t, 3>(normals, 4, n);
    out.positions_mm.push_back({at[0] + p[0] * scale, at[1] + p[1] * scale, at[2] + p[2] * scale});
    out.normals.push_back(Vec3{double(q[0]), double(q[1]), double(q[2])} * (1.0 / 127));
    out.original.push_back(element<std::uint8_t, 4>(normals, 4, n)[3]);
  }
  const auto index = accessor(primitive["indices"]);
  const auto indices = bytes_of(index);
  for (std::size_t n = 0; n < index["count"].get<std::size_t>(); ++n) {
    out.indices.push_back(index["componentType"] == 5125
                              ? element<std::uint32_t, 1>(indices, 4, n)[0]
                              : element<std::uint16_t, 1>(indices, 2, n)[0]);
  }
}

/// Reads a mesh frame as the glTF specification defines it. Shares no code with its writer.
/// `tile_mm` is the side of a tile, for nodes that represent several tiles.
inline DecodedFrame read_mesh_glb(const std::vector<std::byte>& glb_bytes, double tile_mm = 0) {
  const GlbParts glb = split_glb(glb_bytes);
  DecodedFrame frame;
  frame.from = glb.json["scenes"][0]["extras"]["from"].get<std::uint64_t>();
  frame.to = glb.json["scenes"][0]["extras"]["to"].get<std::uint64_t>();
  if (!glb.json.contains("nodes")) return frame;
  frame.nodes = glb.json["nodes"].size();
  for (const auto& node : glb.json["nodes"]) {
    const TileIndex tile{node["extras"]["tile"][0], node["extras"]["tile"][1]};
    EXPECT_EQ(node["name"], "t_" + std::to_string(tile.x) + "_" + std::to_string(tile.y));
    DecodedTile& out = frame.tiles[tile];
    out.version = node["extras"]["version"].get<std::uint64_t>();
    out.level = node["extras"].value("level", 0);
    out.digest = std::stoull(node["extras"].value("digest", std::string("0")), nullptr, 16);
    if (node.contains("mesh")) decode_mesh(glb, node, out);
    const auto repeat = node["extras"].value("repeat", std::array{1, 1});
    for (int n = 1; n < repeat[0] * repeat[1]; ++n) {
      const TileIndex move{n % repeat[0], n / repeat[0]};
      const TileIndex at{tile.x + move.x, tile.y + move.y};
      EXPECT_FALSE(frame.tiles.contains(at)) << at.x << " " << at.y;
      DecodedTile& copy = frame.tiles[at] = out;
      for (Vec3& p : copy.positions_mm) {
        p = p + Vec3{move.x * tile_mm, move.y * tile_mm, 0};
      }
    }
  }
  return frame;
}

/// Returns the tile's triangles, as corners with their normals and their original flags, in an
/// order that does not depend on the encoding.
inline std::vector<std::array<std::array<double, 7>, 3>> triangles_of(const DecodedTile& tile) {
  std::vector<std::array<std::array<double, 7>, 3>> triangles;
  for (std::size_t t = 0; t + 2 < tile.indices.size(); t += 3) {
    auto& triangle = triangles.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3 p = tile.positions_mm.at(tile.indices[t + c]);
      const Vec3 n = tile.normals.at(tile.indices[t + c]);
      const double original = tile.original.at(tile.indices[t + c]);
      triangle[c] = {p.x, p.y, p.z, n.x, n.y, n.z, original};
    }
    // The smallest of its three rotations, because two corners may have the same lattice point.
    auto turned = triangle;
    for (int turn = 0; turn < 2; ++turn) {
      std::rotate(turned.begin(), turned.begin() + 1, turned.end());
      triangle = std::min(triangle, turned);
    }
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

}  // namespace kerf::test
