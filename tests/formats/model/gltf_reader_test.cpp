// SPDX-License-Identifier: Apache-2.0
#include <meshoptimizer.h>

#include "server/formats/model/mesh_reader.h"
#include "tests/support/test.h"

namespace kerf::gltf_reader_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

void put_word(std::string& text, std::size_t word) {
  for (int n = 0; n < 4; ++n) text += static_cast<char>(word >> (8 * n) & 0xffU);
}

std::string glb(std::string json, std::string binary) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  binary.resize((binary.size() + 3) / 4 * 4, '\0');
  std::string file = "glTF";
  put_word(file, 2);
  put_word(file, 12 + 8 + json.size() + 8 + binary.size());
  put_word(file, json.size());
  file += "JSON" + json;
  put_word(file, binary.size());
  file += std::string("BIN\0", 4) + binary;
  return file;
}

/// Five corners of a pyramid as floats (60 bytes), then as unsigned bytes with a stride of 4.
std::string corners() {
  std::string bytes;
  const float floats[] = {0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1, 0, 1, 0};
  bytes.append(reinterpret_cast<const char*>(floats), sizeof floats);
  for (const float c : floats) {
    bytes += static_cast<char>(c > 0 ? 0xff : 0);
    if ((bytes.size() - 60) % 4 == 3) bytes += '\0';
  }
  return bytes + std::string{0, 1, 2, 0, 2, 3};  // at 80
}

/// A file whose only mesh has the given primitive, in a node with the given fields.
std::string file_of(const std::string& primitive, const std::string& node = "",
                    const std::string& more = "") {
  return glb(R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0)" +
                 node + R"(}], "meshes": [{"primitives": [)" + primitive + R"(]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3"},
                  {"bufferView": 1, "componentType": 5121, "count": 5, "type": "VEC3", "normalized": true},
                  {"bufferView": 2, "componentType": 5121, "count": 6, "type": "SCALAR"},
                  {"bufferView": 0, "componentType": 5126, "count": 6, "type": "VEC3"}],
    "bufferViews": [{"buffer": 0, "byteLength": 60}, {"buffer": 0, "byteOffset": 60, "byteLength": 20, "byteStride": 4},
                    {"buffer": 0, "byteOffset": 80, "byteLength": 6}],
    "buffers": [{"byteLength": 86}])" +
                 more + "}",
             corners());
}

MeshFileResult read(const std::string& bytes, std::uint64_t most = 1000) {
  return read_mesh(MeshFileFormat::kGlb, std::as_bytes(std::span(bytes)), most);
}

TEST(GltfReader, ConvertsToMillimetersWithZUp) {
  for (const char* position : {"0", "1"}) {
    const auto mesh = test::value_of(read(file_of(std::string(R"({"attributes": {"POSITION": )") +
                                                  position + R"(}, "indices": 2})")));
    EXPECT_THAT(mesh.vertices_mm, ElementsAre(Vec3{0, 0, 0}, Vec3{1000, 0, 0}, Vec3{1000, -1000, 0},
                                              Vec3{0, -1000, 0}, Vec3{0, 0, 1000}));
    EXPECT_THAT(mesh.triangles, ElementsAre(std::array<std::uint32_t, 3>{0, 1, 2},
                                            std::array<std::uint32_t, 3>{0, 2, 3}));
  }
}

TEST(GltfReader, NodesPlaceTheirMeshes) {
  // Scaled by 2 along y, turned by 90 degrees about x, moved. The parent mirrors x.
  const auto mesh =
      test::value_of(read(glb(R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [1]}],
    "nodes": [{"mesh": 0, "scale": [1, 2, 1], "rotation": [0.7071067811865476, 0, 0, 0.7071067811865476], "translation": [0, 0, 7]},
              {"children": [0], "matrix": [-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 6}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3"}],
    "bufferViews": [{"buffer": 0, "byteLength": 60}], "buffers": [{"byteLength": 60}]})",
                              corners())));
  // (0, 1, 0): (0, 2, 0), then (0, 0, 2), then (0, 0, 9): in the scene (0, -9000, 0).
  const Vec3 tip = mesh.vertices_mm[4];
  EXPECT_NEAR(tip.y, -9000, 1e-9);
  EXPECT_NEAR(tip.z, 0, 1e-9);
  EXPECT_NEAR(mesh.vertices_mm[1].x, -1000, 1e-9);
  // A fan, turned because the matrix mirrors.
  EXPECT_THAT(mesh.triangles, ElementsAre(std::array<std::uint32_t, 3>{1, 0, 2},
                                          std::array<std::uint32_t, 3>{2, 0, 3},
                                          std::array<std::uint32_t, 3>{3, 0, 4}));
}

/// A file of this many nodes, each the child of the previous one, or nested.
std::string nodes(int count, bool nested) {
  std::string json = R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{})";
  for (int n = 1; n < count; ++n)
    json += nested ? R"(,{"extras": [{})" : ",{\"children\": [" + std::to_string(n) + "]}";
  if (nested) {
    for (int n = 1; n < count; ++n) json += "]}";
  }
  return glb(json + "]}", "");
}

TEST(GltfReader, ManyNodesAreRejectedByTheirNumber) {
  for (const bool nested : {false, true}) EXPECT_FALSE(read(nodes(100'000, nested)));
  const auto error = test::error_of(read(nodes(250'001, false)));
  EXPECT_STREQ(to_string(error.code), "too_large");
  EXPECT_THAT(error.reason, testing::HasSubstr("250001 nodes; the limit is 250000"));
}

TEST(GltfReader, ReadsStripsAndSkipsLines) {
  const auto mesh = test::value_of(read(file_of(
      R"({"attributes": {"POSITION": 0}, "mode": 5}, {"attributes": {"POSITION": 0}, "mode": 1})")));
  EXPECT_THAT(mesh.triangles, ElementsAre(std::array<std::uint32_t, 3>{0, 1, 2},
                                          std::array<std::uint32_t, 3>{1, 3, 2},
                                          std::array<std::uint32_t, 3>{2, 3, 4}));
}

/// Compresses according to EXT_meshopt_compression 1.0.
std::string packed_vertices(const std::string& bytes, std::size_t count, std::size_t stride) {
  meshopt_encodeVertexVersion(0);
  std::vector<unsigned char> out(meshopt_encodeVertexBufferBound(count, stride));
  out.resize(meshopt_encodeVertexBuffer(out.data(), out.size(), bytes.data(), count, stride));
  return {out.begin(), out.end()};
}
std::string packed_triangles(const std::vector<unsigned>& indices) {
  meshopt_encodeIndexVersion(1);
  std::vector<unsigned char> out(meshopt_encodeIndexBufferBound(indices.size(), 1000));
  out.resize(meshopt_encodeIndexBuffer(out.data(), out.size(), indices.data(), indices.size()));
  return {out.begin(), out.end()};
}

/// A file like this server's `meshopt` downloads and those of gltfpack: compressed views of a
/// buffer that exists only unpacked. `vertices` and `triangles` replace fields of the two
/// extensions.
std::string meshopt_file(const std::string& vertices = "", const std::string& triangles = "") {
  std::string positions = packed_vertices(corners().substr(0, 60), 5, 12);
  const std::size_t length = positions.size();
  positions.resize((length + 3) / 4 * 4);
  const std::string indices = packed_triangles({0, 1, 2, 0, 2, 3});
  const auto extension = [](const std::string& fields) {
    return R"("extensions": {"EXT_meshopt_compression": {"buffer": 0, )" + fields + "}}";
  };
  const auto text = [](std::size_t n) { return std::to_string(n); };
  const std::string of_vertices =
      R"("byteLength": )" + text(length) +
      (vertices.empty() ? R"(, "byteStride": 12, "count": 5, "mode": "ATTRIBUTES")" : vertices);
  const std::string of_triangles =
      R"("byteOffset": )" + text(positions.size()) + R"(, "byteLength": )" + text(indices.size()) +
      (triangles.empty() ? R"(, "byteStride": 2, "count": 6, "mode": "TRIANGLES")" : triangles);
  return glb(
      R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 2}, "indices": 1}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 5, "type": "VEC3"},
                  {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
                  {"bufferView": 2, "componentType": 5126, "count": 5, "type": "VEC3"}],
    "bufferViews": [{"buffer": 1, "byteLength": 60, "byteStride": 12, )" +
          extension(of_vertices) + R"(}, {"buffer": 1, "byteOffset": 60, "byteLength": 12, )" +
          extension(of_triangles) +
          R"(}, {"buffer": 1, "byteOffset": 72, "byteLength": 60}],
    "buffers": [{"byteLength": )" +
          text(positions.size() + indices.size()) +
          R"(}, {"byteLength": 132, "extensions": {"EXT_meshopt_compression": {"fallback": true}}}],
    "extensionsUsed": ["EXT_meshopt_compression"], "extensionsRequired": ["EXT_meshopt_compression"]})",
      positions + indices);
}

TEST(GltfReader, UnpacksMeshoptCompression) {
  const auto plain = read(file_of(R"({"attributes": {"POSITION": 0}, "indices": 2})"));
  EXPECT_EQ(test::value_of(read(meshopt_file())), *plain);
}

TEST(GltfReader, RejectsInvalidMeshoptCompression) {
  const auto reason_of = [](const std::string& file) {
    const auto mesh = read(file);
    EXPECT_FALSE(mesh);
    return mesh ? std::string() : mesh.error().reason;
  };
  const auto vertices = [](const std::string& fields) { return meshopt_file(", " + fields); };
  const auto triangles = [](const std::string& fields) { return meshopt_file("", ", " + fields); };
  EXPECT_THAT(reason_of(vertices(R"("byteStride": 13, "count": 5, "mode": "ATTRIBUTES")")),
              HasSubstr("bufferView 0 (EXT_meshopt_compression): its byteStride is invalid"));
  EXPECT_THAT(
      reason_of(vertices(R"("byteStride": 12, "count": 999999999999, "mode": "ATTRIBUTES")")),
      HasSubstr("more elements than its bytes can hold"));
  EXPECT_THAT(reason_of(vertices(
                  R"("byteStride": 12, "count": 5, "mode": "ATTRIBUTES", "filter": "OCTAHEDRAL")")),
              HasSubstr("no filter but EXPONENTIAL"));
  EXPECT_THAT(reason_of(triangles(R"("byteStride": 2, "count": 6, "mode": "INDICES")")),
              HasSubstr("its compressed data are invalid"));
  EXPECT_THAT(reason_of(triangles(R"("byteStride": 2, "count": 5, "mode": "TRIANGLES")")),
              HasSubstr("its compressed data are invalid"));
  EXPECT_THAT(reason_of(triangles(R"("count": 6, "mode": "TRIANGLES")")), HasSubstr("byteStride"));
  const std::string whole = meshopt_file();
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x13);
    read(damaged);  // at worst an error
  }
}

TEST(GltfReader, ReplacesElementsOfSparseAccessors) {
  // Vertex 2 of the pyramid moves to (0, 0, 1). Without a view the other vertices are at the
  // origin.
  for (const bool based : {true, false}) {
    const std::string base = based ? R"("bufferView": 0, )" : "";
    std::string bytes = corners();
    bytes.resize(88);
    bytes += std::string{2, 0, 0, 0};  // the index, at 88
    bytes += bytes.substr(36, 12);     // (0, 0, 1), at 92
    const auto mesh =
        read(glb(R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}],
      "nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
      "accessors": [{)" +
                     base +
                     R"("componentType": 5126, "count": 5, "type": "VEC3", "sparse": {"count": 1,
                       "indices": {"bufferView": 2, "componentType": 5121}, "values": {"bufferView": 3}}},
                    {"bufferView": 1, "componentType": 5121, "count": 6, "type": "SCALAR"}],
      "bufferViews": [{"buffer": 0, "byteLength": 60}, {"buffer": 0, "byteOffset": 80, "byteLength": 6},
                      {"buffer": 0, "byteOffset": 88, "byteLength": 4}, {"buffer": 0, "byteOffset": 92, "byteLength": 12}],
      "buffers": [{"byteLength": 104}]})",
                 bytes));
    if (!based) {
      EXPECT_FALSE(mesh);  // no triangle with three corners
      continue;
    }
    ASSERT_TRUE(mesh) << mesh.error().reason;
    EXPECT_THAT(mesh->vertices_mm, testing::Contains(Vec3{0, -1000, 0}));
    EXPECT_THAT(mesh->vertices_mm, testing::Not(testing::Contains(Vec3{1000, -1000, 0})));
  }
}

TEST(GltfReader, RejectsInvalidFilesWithTheReason) {
  const auto reason_of = [](const MeshFileResult& result) {
    EXPECT_FALSE(result);
    return result ? std::string()
                  : std::string(to_string(result.error().code)) + ": " + result.error().reason;
  };
  const std::string plain = R"({"attributes": {"POSITION": 0}, "indices": 2})";
  EXPECT_THAT(reason_of(read("solid part")),
              HasSubstr("syntax: the file does not begin as binary glTF"));
  EXPECT_THAT(reason_of(read(file_of(R"({"attributes": {"POSITION": 3}})"))),
              HasSubstr("truncated: accessor 3"));
  EXPECT_THAT(reason_of(read(file_of(R"({"attributes": {"POSITION": 9}})"))),
              HasSubstr("accessor 9 does not exist"));
  EXPECT_THAT(reason_of(read(file_of(R"({"attributes": {"POSITION": 2}})"))),
              HasSubstr("three components"));
  EXPECT_THAT(reason_of(read(file_of(R"({"attributes": {"POSITION": 0}, "indices": 0})"))),
              HasSubstr("unsigned integers"));
  EXPECT_THAT(reason_of(read(file_of(plain, R"(, "children": [0])"))), HasSubstr("64 deep"));
  EXPECT_THAT(reason_of(read(file_of(plain), 1)), HasSubstr("too_large"));
  EXPECT_THAT(reason_of(read(
                  file_of(plain, "", R"(, "extensionsRequired": ["KHR_draco_mesh_compression"])"))),
              HasSubstr("unsupported: the file requires the extension KHR_draco_mesh_compression"));
  std::string outside = file_of(plain);
  outside.replace(outside.find(R"({"byteLength": 86})"), 18,
                  R"({"uri":"/etc/hi"})"
                  " ");
  EXPECT_FALSE(read(outside));
  const std::string deep(200'000, '[');
  EXPECT_FALSE(read(glb(R"({"nodes": )" + deep + std::string(deep.size(), ']') + "}", corners())));
  // An image with an invalid view does not affect the triangles.
  EXPECT_TRUE(
      read(file_of(plain, "", R"(, "images": [{"bufferView": 7, "mimeType": "image/png"}])")));
  const std::string whole = file_of(plain);
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_FALSE(read(whole.substr(0, size))) << size;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x13);
    read(damaged);  // at worst an error
  }
}

}  // namespace
}  // namespace kerf::gltf_reader_test
