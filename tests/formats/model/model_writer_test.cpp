// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/model_writer.h"

#include <sys/resource.h>
#include <tiny_gltf.h>
#include <unistd.h>

#include <csignal>

#include "server/formats/model/vertex_welder.h"
#include "tests/support/carvings.h"
#include "tests/support/model_files.h"
#include "tests/support/test.h"
#include "tests/support/thread_workers.h"

namespace kerf::model_writer_test {
namespace {

namespace fs = std::filesystem;
using test::ReadModel;

const BoxStock kBlock{{-6, 4, 2}, {30, 36, 9}};

SolidSnapshot carved_block(unsigned seed, Vec3 moved = {}) {
  const BoxStock block{kBlock.min_mm + moved, kBlock.max_mm + moved};
  Sculpture sculpture = test::make_sculpture(block, 0.4);
  test::RandomCarver carver(sculpture, block.min_mm, block.max_mm, seed);
  for (int n = 0; n < 25; ++n) carver.cut();
  return sculpture.solid();
}

fs::path scratch_file(const std::string& name) {
  return fs::path(::testing::TempDir()) / (std::to_string(::getpid()) + name);
}

struct Written {
  ModelSummary summary;
  std::string bytes;
};
Written write(const SolidSnapshot& snapshot, ModelFormat format, ModelEncoding encoding,
              const std::string& title = "block") {
  const fs::path path = scratch_file(std::string("_model.") + to_string(format));
  SnapshotMesh mesh(snapshot);
  double last = 0;
  const auto summary = write_model(
      path, mesh,
      {.format = format, .encoding = encoding, .title = title, .progress = [&](double share) {
         last = share;
       }});
  EXPECT_TRUE(summary) << summary.error().reason;
  EXPECT_EQ(last, 1);
  Written written{*summary, test::content_of(path)};
  EXPECT_EQ(written.bytes.size(), summary->bytes);
  EXPECT_FALSE(fs::exists(path.string() + ".spool"));
  fs::remove(path);
  return written;
}
Written write(const SolidSnapshot& snapshot, ModelFormat format) {
  return write(snapshot, format, model_encodings(format).front());
}

ReadModel read(const Written& written, ModelFormat format) {
  switch (format) {
    case ModelFormat::kStl:
      return test::read_stl_bytes(written.bytes);
    case ModelFormat::kGlb:
      return test::read_model_glb(written.bytes);
    case ModelFormat::kPly:
      return test::read_ply_bytes(written.bytes);
    case ModelFormat::kObj:
      return test::read_obj_text(written.bytes);
    case ModelFormat::k3mf:
      break;  // threemf_test reads it with the format's own library
  }
  return {};
}

test::GlbParts parts_of(const std::string& glb) {
  const auto* first = reinterpret_cast<const std::byte*>(glb.data());
  return test::split_glb({first, first + glb.size()});
}

tinygltf::Model load(const std::string& glb) {
  tinygltf::Model model;
  std::string error, warning;
  const bool ok = tinygltf::TinyGLTF().LoadBinaryFromMemory(
      &model, &error, &warning, reinterpret_cast<const unsigned char*>(glb.data()),
      static_cast<unsigned>(glb.size()));
  EXPECT_TRUE(ok) << error;
  EXPECT_TRUE(warning.empty()) << warning;
  return model;
}

TEST(ModelWriter, AllFormatsContainBitIdenticalTriangles) {
  for (const Vec3 moved : {Vec3{}, Vec3{700, -900, 40}}) {
    const SolidSnapshot snapshot = carved_block(3, moved);
    const ReadModel stl = read(write(snapshot, ModelFormat::kStl), ModelFormat::kStl);
    const auto triangles = test::sorted_triangles(stl);
    ASSERT_GT(triangles.size(), 3000U);
    EXPECT_NEAR(test::volume_mm3(stl), snapshot.fields.front().volume_mm3(),
                0.03 * snapshot.fields.front().volume_mm3());
    for (const ModelFormat format : {ModelFormat::kPly, ModelFormat::kObj}) {
      const ReadModel model = read(write(snapshot, format), format);
      EXPECT_EQ(test::sorted_triangles(model), triangles) << to_string(format);
    }
    const auto ascii = write(snapshot, ModelFormat::kStl, ModelEncoding::kAscii);
    EXPECT_EQ(test::sorted_triangles(test::read_stl_text(ascii.bytes)), triangles);
    EXPECT_TRUE(ascii.bytes.starts_with("solid block\n"));
  }
}

TEST(ModelWriter, IndexedFormatsAreClosedByTheirIndices) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const SolidSnapshot snapshot = carved_block(seed);
    for (const ModelFormat format : {ModelFormat::kPly, ModelFormat::kObj}) {
      const Written written = write(snapshot, format);
      const ReadModel model = read(written, format);
      EXPECT_EQ(test::unmatched_edges(model), 0U) << to_string(format) << seed;
      EXPECT_EQ(model.vertices.size(), written.summary.vertices);
      EXPECT_EQ(model.triangles.size(), written.summary.triangles);
    }
  }
}

TEST(ModelWriter, ExportCostDependsOnTheCarvedArea) {
  std::array<std::size_t, 2> triangles{}, bytes{};
  std::array<double, 2> removed_mm3{};
  for (const std::size_t n : {0U, 1U}) {
    const double side = n == 0 ? 128 : 10240;
    Sculpture sculpture =
        test::make_sculpture(BoxStock{{-side / 2, -side / 2, -20}, {side / 2, side / 2, 0}}, 0.5);
    ASSERT_TRUE(sculpture.apply(DefineTool{1, make_tool(BallShape{20, 60}).value()}));
    ASSERT_TRUE(sculpture.apply(MoveTool{1, {{-30, -9, -4}}, {{30, 22, -7}}, 1, false}));
    const Written ply = write(sculpture.solid(), ModelFormat::kPly);
    const ReadModel model = read(ply, ModelFormat::kPly);
    EXPECT_EQ(test::unmatched_edges(model), 0U);
    triangles[n] = ply.summary.triangles;
    bytes[n] = ply.summary.bytes;
    removed_mm3[n] = side * side * 20 - test::volume_mm3(model);
  }
  EXPECT_LT(triangles[1], 2 * triangles[0]);
  EXPECT_LT(bytes[1], 2 * bytes[0]);
  // Far from the block's corner, floats are coarser.
  EXPECT_NEAR(removed_mm3[1], removed_mm3[0], 0.01 * removed_mm3[0]);
}

TEST(ModelWriter, EqualBlocksGiveEqualBytes) {
  for (const ModelFormat format : kModelFormats) {
    for (const ModelEncoding encoding : model_encodings(format)) {
      const auto once = write(carved_block(5), format, encoding);
      EXPECT_EQ(once.bytes, write(carved_block(5), format, encoding).bytes) << to_string(encoding);
      EXPECT_NE(once.bytes, write(carved_block(6), format, encoding).bytes) << to_string(encoding);
    }
  }
}

TEST(ModelWriter, EmptyStockGivesAnEmptyModelInEveryFormat) {
  Sculpture sculpture = test::make_sculpture(BoxStock{{0, 0, 0}, {4, 4, 4}}, 0.5);
  ASSERT_TRUE(sculpture.apply(DefineTool{1, make_tool(FlatShape{20, 40}).value()}));
  ASSERT_TRUE(sculpture.apply(MoveTool{1, {{2, 2, -1}}, {{2, 2, -1}}, 1, false}));
  const SolidSnapshot gone = sculpture.solid();
  for (const ModelFormat format : kModelFormats) {
    for (const ModelEncoding encoding : model_encodings(format)) {
      EXPECT_EQ(write(gone, format, encoding).summary.triangles, 0U) << to_string(format);
    }
  }
  EXPECT_TRUE(load(write(gone, ModelFormat::kGlb).bytes).meshes.empty());
}

TEST(SnapshotMesh, ThreadCountDoesNotChangeThePieces) {
  const SolidSnapshot snapshot = carved_block(3);
  test::ThreadWorkers workers(3);
  for (const FlatFaces faces : {FlatFaces::kMerged, FlatFaces::kByTile}) {
    SnapshotMesh alone(snapshot, faces), together(snapshot, faces, &workers);
    MeshPiece one, other;
    int pieces = 0;
    while (alone.next(one)) {
      ++pieces;
      ASSERT_TRUE(together.next(other));
      EXPECT_EQ(one.positions_mm, other.positions_mm);
      EXPECT_EQ(one.normals, other.normals);
      EXPECT_EQ(one.indices, other.indices);
    }
    EXPECT_GT(pieces, 1);
    EXPECT_FALSE(together.next(other));
    EXPECT_EQ(together.share(), 1);
  }
}

TEST(ModelWriter, ReportsAnUnwritablePathAndLeavesNoFile) {
  for (const ModelFormat format : kModelFormats) {
    SnapshotMesh mesh(carved_block(1));
    const fs::path path = scratch_file("_no_such_folder") / "model";
    const auto error = test::error_of(write_model(path, mesh, {.format = format}));
    EXPECT_NE(error.reason.find("No such file"), std::string::npos) << error.reason;
    EXPECT_FALSE(fs::exists(path));
  }
}

/// Limits the size of files of this process.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

TEST(ModelWriter, ReportsAFullDiskAndLeavesNoFile) {
  const SolidSnapshot snapshot = carved_block(1);
  for (const ModelFormat format : kModelFormats) {
    const fs::path path = scratch_file("_too_large");
    SnapshotMesh mesh(snapshot);
    std::expected<ModelSummary, ModelError> written;
    {
      const FileSizeLimit limit(10'000);
      written =
          write_model(path, mesh, {.format = format, .encoding = model_encodings(format).front()});
    }
    ASSERT_FALSE(written) << to_string(format);
    EXPECT_FALSE(written.error().reason.empty());
    EXPECT_FALSE(fs::exists(path));
    EXPECT_FALSE(fs::exists(path.string() + ".spool"));
  }
}

TEST(StlWriter, NeverBeginsWithSolid) {
  const auto written =
      write(carved_block(2), ModelFormat::kStl, ModelEncoding::kBinary, "solid as\na rock");
  EXPECT_TRUE(written.bytes.starts_with("Kerf STL, mm: solid as a rock"));
}

TEST(StlWriter, SatisfiesAdmesh) {
  if (std::system("command -v admesh > /dev/null 2>&1") != 0) GTEST_SKIP() << "admesh is not here";
  for (const ModelEncoding encoding : model_encodings(ModelFormat::kStl)) {
    const fs::path path = scratch_file("_admesh.stl");
    std::ofstream(path, std::ios::binary)
        << write(carved_block(4), ModelFormat::kStl, encoding).bytes;
    std::FILE* pipe = ::popen(("admesh -n -u -f -d -v " + path.string()).c_str(), "r");
    ASSERT_NE(pipe, nullptr);
    std::string report;
    for (std::array<char, 256> line{}; std::fgets(line.data(), line.size(), pipe) != nullptr;) {
      report += line.data();
    }
    EXPECT_EQ(::pclose(pipe), 0);
    const std::size_t at = report.find("Total disconnected facets");
    ASSERT_NE(at, std::string::npos) << report;
    const std::string line = report.substr(at, report.find('\n', at) - at);
    EXPECT_EQ(line.find_first_of("123456789"), std::string::npos) << line;
    const std::size_t degenerate = report.find("Degenerate facets");
    ASSERT_NE(degenerate, std::string::npos);
    EXPECT_EQ(std::atoi(report.c_str() + report.find(':', degenerate) + 1), 0) << report;
    fs::remove(path);
  }
}

TEST(ObjWriter, KeepsNormalsOfSharedVertices) {
  std::size_t normals = 0;
  const auto written = write(carved_block(2), ModelFormat::kObj);
  const ReadModel model = test::read_obj_text(written.bytes, &normals);
  EXPECT_GT(normals, model.vertices.size());  // creases have several
}

TEST(GlbWriter, IsOneObjectWithTheNameOfTheSceneInMetersAndYUp) {
  Sculpture sculpture = test::make_sculpture(BoxStock{{100, 200, 300}, {120, 220, 310}}, 0.5);
  const SolidSnapshot snapshot = sculpture.solid();
  for (const ModelEncoding encoding : model_encodings(ModelFormat::kGlb)) {
    const auto written = write(snapshot, ModelFormat::kGlb, encoding, "a \"quoted\" name");
    const test::GlbParts glb = parts_of(written.bytes);
    EXPECT_EQ(glb.json["asset"]["extras"]["scene"], "a \"quoted\" name");
    ASSERT_EQ(glb.json["nodes"].size(), 1U);
    ASSERT_EQ(glb.json["meshes"].size(), 1U);
    const auto& node = glb.json["nodes"][0];
    EXPECT_EQ(node["name"], "a \"quoted\" name");
    EXPECT_EQ(glb.json["meshes"][0]["name"], "a \"quoted\" name");
    // World Z of the block is glTF's Y, so its lowest corner is at (0.1, 0.3, -0.2) m.
    const auto& position = glb.json["accessors"][0];
    const auto low = position["min"].get<std::array<double, 3>>();
    const auto high = position["max"].get<std::array<double, 3>>();
    const double scale = node["scale"][0].get<double>();
    const auto place = node["translation"].get<std::array<double, 3>>();
    EXPECT_NEAR(place[0] + scale * low[0], 0.1, 1e-12);
    EXPECT_NEAR(place[1] + scale * low[2], 0.3, 1e-12);
    EXPECT_NEAR(place[2] - scale * low[1], -0.2, 1e-12);
    EXPECT_NEAR(place[0] + scale * high[0], 0.12, 1e-6);
    EXPECT_NEAR(place[1] + scale * high[2], 0.31, 1e-6);
    EXPECT_NEAR(place[2] - scale * high[1], -0.22, 1e-6);
    ASSERT_EQ(glb.json["meshes"][0]["primitives"].size(), 1U);  // a box is one group
    const auto index = glb.json["meshes"][0]["primitives"][0]["indices"].get<std::size_t>();
    EXPECT_EQ(glb.json["accessors"][index]["count"], 3 * 12U);
  }
  const auto unnamed = write(snapshot, ModelFormat::kGlb, ModelEncoding::kFloat, "");
  EXPECT_EQ(parts_of(unnamed.bytes).json["nodes"][0]["name"], "kerf");
}

TEST(GlbWriter, FloatPositionsAreExactAndIndicesHave16Bits) {
  Sculpture sculpture = test::make_sculpture(BoxStock{{0, 0, 0}, {60, 60, 20}}, 0.2);
  test::RandomCarver carver(sculpture, {0, 0, 5}, {60, 60, 20}, 7);
  for (int n = 0; n < 200; ++n) carver.cut();
  const SolidSnapshot snapshot = sculpture.solid();
  const auto written = write(snapshot, ModelFormat::kGlb);
  const ReadModel glb = read(written, ModelFormat::kGlb);
  const ReadModel stl = read(write(snapshot, ModelFormat::kStl), ModelFormat::kStl);
  EXPECT_EQ(test::sorted_triangles(glb),
            test::sorted_triangles(stl));  // the box's corner is at zero
  const tinygltf::Model model = load(written.bytes);
  EXPECT_GT(model.meshes.at(0).primitives.size(), 1U);
  for (const tinygltf::Primitive& primitive : model.meshes.at(0).primitives) {
    const auto& indices = model.accessors.at(std::size_t(primitive.indices));
    EXPECT_EQ(indices.componentType, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT);
  }
}

TEST(GlbWriter, QuantizedSurfaceStaysClosedAndWithinHalfAStep) {
  const SolidSnapshot snapshot = carved_block(8);
  const auto exact = read(write(snapshot, ModelFormat::kGlb), ModelFormat::kGlb);
  const double step = 36.0 / 32768;  // the power of two above 36/65535
  for (const ModelEncoding encoding : {ModelEncoding::kQuantized, ModelEncoding::kMeshopt}) {
    const auto written = write(snapshot, ModelFormat::kGlb, encoding);
    ReadModel model = read(written, ModelFormat::kGlb);
    EXPECT_LE(model.triangles.size(), exact.triangles.size());
    EXPECT_GE(model.triangles.size(), exact.triangles.size() * 99 / 100);
    EXPECT_NEAR(test::volume_mm3(model), test::volume_mm3(exact), step * 100);
    // Compare by position, because groups repeat the vertices on their seams. Coinciding positions
    // may share an edge twice, but every edge still has as many opposites.
    std::map<std::array<test::Corner, 2>, int> edges;
    for (const auto& t : model.triangles) {
      for (std::size_t c = 0; c < 3; ++c) {
        const auto &a = model.vertices.at(t[c]), &b = model.vertices.at(t[(c + 1) % 3]);
        EXPECT_NE(a, b);
        ++edges[{a, b}];
        --edges[{b, a}];
      }
    }
    for (const auto& [edge, count] : edges) EXPECT_EQ(count, 0);
    // Compression reorders vertices; without it each one can be compared.
    if (encoding == ModelEncoding::kMeshopt) continue;
    ASSERT_EQ(model.vertices.size(), exact.vertices.size());
    for (std::size_t n = 0; n < exact.vertices.size(); ++n) {
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(model.vertices[n][c], exact.vertices[n][c], step / 2 + 1e-6);
      }
    }
  }
  const auto plain = write(snapshot, ModelFormat::kGlb).bytes.size();
  const auto quantized = write(snapshot, ModelFormat::kGlb, ModelEncoding::kQuantized).bytes.size();
  const auto packed = write(snapshot, ModelFormat::kGlb, ModelEncoding::kMeshopt).bytes.size();
  EXPECT_LT(quantized, plain * 2 / 3);
  EXPECT_LT(packed, quantized * 2 / 3);
}

TEST(VertexWelder, ForgetsVerticesWithAClosedFan) {
  Sculpture sculpture = test::make_sculpture(BoxStock{{0, 0, 0}, {200, 40, 10}}, 0.25);
  test::RandomCarver carver(sculpture, {0, 0, 0}, {200, 40, 10}, 9);
  for (int n = 0; n < 200; ++n) carver.cut();
  SnapshotMesh mesh(sculpture.solid());
  VertexWelder welder;
  std::size_t most = 0;
  for (MeshPiece piece; mesh.next(piece);) {
    welder.weld(piece);
    most = std::max(most, welder.remembered());
  }
  EXPECT_EQ(welder.remembered(), 0U);
  EXPECT_LT(most, welder.vertices() / 10);
}

}  // namespace
}  // namespace kerf::model_writer_test
