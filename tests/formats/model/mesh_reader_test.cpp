// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/mesh_reader.h"

#include <unistd.h>

#include "kernel/dexel/mesh_stock.h"
#include "server/formats/model/model_writer.h"
#include "tests/support/carvings.h"
#include "tests/support/model_files.h"
#include "tests/support/test.h"

namespace kerf::mesh_reader_test {
namespace {

namespace fs = std::filesystem;

std::string written(ModelFormat format, ModelEncoding encoding) {
  const BoxStock block{{-6, 4, 2}, {8, 16, 9}};
  Sculpture sculpture = test::make_sculpture(block, 0.4);
  test::RandomCarver carver(sculpture, block.min_mm, block.max_mm, 3);
  for (int n = 0; n < 12; ++n) carver.cut();
  const fs::path path = fs::path(::testing::TempDir()) / (std::to_string(::getpid()) + "_read");
  SnapshotMesh mesh(sculpture.solid());
  EXPECT_TRUE(write_model(path, mesh, {.format = format, .encoding = encoding}));
  std::string text = test::content_of(path);
  fs::remove(path);
  return text;
}

MeshFileResult read(MeshFileFormat format, std::string_view text, std::uint64_t most = 100'000) {
  return read_mesh(format, std::as_bytes(std::span(text)), most);
}

MeshFileErrorCode code_of(MeshFileFormat format, std::string_view text, std::uint64_t most = 1000) {
  const auto result = read(format, text, most);
  EXPECT_FALSE(result) << text;
  if (result) return MeshFileErrorCode{99};
  EXPECT_FALSE(result.error().reason.empty());
  return result.error().code;
}

const std::string kAsciiPly =
    "ply\r\nformat ascii 1.0\r\ncomment a pyramid\r\nelement vertex 5\r\n"
    "property float nx\r\nproperty double x\r\nproperty double y\r\nproperty double z\r\n"
    "element edge 1\r\nproperty int a\r\nelement face 5\r\nproperty uchar color\r\n"
    "property list uchar int vertex_indices\r\nend_header\r\n"
    "9 0 0 0\n9 2 0 0\n9 2 2 0\n9 0 2 0\n9 1 1 1e0\n7\n"
    "1 4 3 2 1 0\n1 3 0 1 4\n1 3 1 2 4\n1 3 2 3 4\n1 3 3 0 4\n";

const std::string kObj =
    "# a pyramid\nmtllib x.mtl\no p\nv 0 0 0\nv 2 0 0 1.0\nv 2 2 0\nv 0 2 0\nv 1 1 1\nvn 0 0 1\n"
    "usemtl m\nf 4 3 2 1\nf 1/1/1 2//1 5\nf -4 -3 -1\nf 3 4 5\nf 4 1 5\n";

TEST(MeshReader, StopsOnRequest) {
  std::stop_source stop;
  stop.request_stop();
  for (const auto& [format, as, encoding] :
       {std::tuple{MeshFileFormat::kStl, ModelFormat::kStl, ModelEncoding::kBinary},
        {MeshFileFormat::kStl, ModelFormat::kStl, ModelEncoding::kAscii},
        {MeshFileFormat::kPly, ModelFormat::kPly, ModelEncoding::kBinary},
        {MeshFileFormat::kObj, ModelFormat::kObj, ModelEncoding::kAscii},
        {MeshFileFormat::k3mf, ModelFormat::k3mf, ModelEncoding::kAscii},
        {MeshFileFormat::kGlb, ModelFormat::kGlb, ModelEncoding::kBinary}}) {
    const std::string bytes = written(as, encoding);
    const auto error = test::error_of(
        read_mesh(format, std::as_bytes(std::span(bytes)), 100'000, stop.get_token()));
    EXPECT_STREQ(to_string(error.code), "stopped");
  }
}

// -0 is 0; equal vertices get the index of the first one.
TEST(MeshReader, MergesVerticesInTheOrderOfTheFile) {
  const auto mesh =
      test::value_of(read(MeshFileFormat::kObj,
                          "v 3 0 0\nv 0 0 0\nv 0 2 0\nv -0 0 0\nv 3 0 0\nv 0 0 1\nf 1 2 3\n"
                          "f 5 4 6\nf 2 4 3\n"));
  EXPECT_EQ(mesh.vertices_mm, (std::vector<Vec3>{{3, 0, 0}, {0, 0, 0}, {0, 2, 0}, {0, 0, 1}}));
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {0, 1, 3}}));
}

TEST(MeshReader, ReadsBackWrittenFiles) {
  const auto stl = test::value_of(
      read(MeshFileFormat::kStl, written(ModelFormat::kStl, ModelEncoding::kBinary)));
  EXPECT_GT(stl.triangles.size(), 500U);
  const auto ascii =
      test::value_of(read(MeshFileFormat::kStl, written(ModelFormat::kStl, ModelEncoding::kAscii)));
  const auto ply = test::value_of(
      read(MeshFileFormat::kPly, written(ModelFormat::kPly, ModelEncoding::kBinary)));
  const auto obj =
      test::value_of(read(MeshFileFormat::kObj, written(ModelFormat::kObj, ModelEncoding::kAscii)));
  // Text contains the shortest number for the same float, not for the same double.
  const auto corners = [](const TriangleMesh& mesh) {
    std::vector<std::array<float, 9>> all;
    for (const auto& t : mesh.triangles) {
      auto& c = all.emplace_back();
      for (std::size_t n = 0; n < 3; ++n) {
        const Vec3 p = mesh.vertices_mm[t[n]];
        c[3 * n] = static_cast<float>(p.x);
        c[3 * n + 1] = static_cast<float>(p.y);
        c[3 * n + 2] = static_cast<float>(p.z);
      }
    }
    return all;
  };
  EXPECT_EQ(corners(ascii), corners(stl));
  EXPECT_EQ(corners(obj), corners(stl));
  EXPECT_EQ(corners(ply), corners(stl));
  const auto threemf =
      test::value_of(read(MeshFileFormat::k3mf, written(ModelFormat::k3mf, ModelEncoding::kXml)));
  EXPECT_EQ(corners(threemf), corners(stl));
  EXPECT_EQ(ply.vertices_mm.size(), stl.vertices_mm.size());
}

TEST(MeshReader, ReadsForeignPlyAndObj) {
  const auto ply = test::value_of(read(MeshFileFormat::kPly, kAsciiPly));
  EXPECT_EQ(ply.vertices_mm.size(), 5U);
  EXPECT_EQ(ply.triangles.size(), 6U);
  EXPECT_EQ(test::value_of(read(MeshFileFormat::kObj, kObj)), ply);
  std::string big =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty short x\n"
      "property float y\nproperty double z\nelement face 1\n"
      "property list uint8 ushort vertex_index\nend_header\n";
  for (const auto& [x, y] : {std::pair{'\x00', '\x00'}, {'\xff', '\x00'}, {'\x00', '\x3f'}}) {
    big += {x, x, y, y == 0 ? '\0' : '\x80', 0, 0};
    big += std::string(8, '\0');
  }
  big += {3, 0, 0, 0, 1, 0, 2};
  const auto read_big = test::value_of(read(MeshFileFormat::kPly, big));
  EXPECT_EQ(read_big.vertices_mm[1], (Vec3{-1, 0, 0}));
  EXPECT_EQ(read_big.vertices_mm[2], (Vec3{0, 1, 0}));
}

TEST(MeshReader, ReadsBackWrittenGlb) {
  const auto stl = test::value_of(
      read(MeshFileFormat::kStl, written(ModelFormat::kStl, ModelEncoding::kBinary)));
  for (const ModelEncoding encoding : model_encodings(ModelFormat::kGlb)) {
    auto glb = test::value_of(read(MeshFileFormat::kGlb, written(ModelFormat::kGlb, encoding)));
    EXPECT_EQ(mesh_stock_fault(glb), "");
    const BoxStock box = mesh_bounds(glb), expected = mesh_bounds(stl);
    EXPECT_LT(length(box.min_mm - expected.min_mm), 1e-3);
    EXPECT_LT(length(box.max_mm - expected.max_mm), 1e-3);
  }
}

TEST(MeshReader, ReadsStripsOfPly) {
  const std::string head =
      "ply\ncomment first\nformat ascii 1.0\nelement vertex 6\nproperty float x\n"
      "property float y\nproperty float z\nelement tristrips 1\n"
      "property list int int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n";
  const auto mesh = test::value_of(read(MeshFileFormat::kPly, head + "8 0 1 2 3 -1 3 5 4\n"));
  const std::vector<std::array<std::uint32_t, 3>> expected{{0, 1, 2}, {1, 3, 2}, {3, 5, 4}};
  EXPECT_EQ(mesh.triangles, expected);
  EXPECT_EQ(code_of(MeshFileFormat::kPly, head + "3 0 1 6\n"), MeshFileErrorCode::kBadIndex);
}

TEST(MeshReader, JoinsContinuedLinesOfObj) {
  const std::string head = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  for (const char* end : {"\\\n", "\\\r\n", " \\\n", " \\\r\n  "}) {
    const auto mesh = test::value_of(read(MeshFileFormat::kObj, head + "f 1 2 3 " + end + " 4\n"));
    EXPECT_EQ(mesh.triangles.size(), 2U);
  }
  const auto error = test::error_of(read(MeshFileFormat::kObj, head + "f 1 2 \\\n 3 9\n"));
  EXPECT_NE(error.reason.find("line 6"), std::string::npos) << error.reason;
}

TEST(MeshReader, ReadsObjInUtf16) {
  const auto plain = test::value_of(read(MeshFileFormat::kObj, kObj));
  for (const bool little : {true, false}) {
    std::string wide = little ? "\xff\xfe" : "\xfe\xff";
    const auto put = [&](char high, char low) {
      wide += little ? low : high;
      wide += little ? high : low;
    };
    put(0, '#');
    put('\x0a', '\x0a');  // a Gurmukhi character, whose bytes are line feeds
    put(0, '\n');
    for (const char c : kObj) put(0, c);
    EXPECT_EQ(test::value_of(read(MeshFileFormat::kObj, wide)), plain);
  }
  EXPECT_TRUE(read(MeshFileFormat::kObj, "\xef\xbb\xbf" + kObj));
}

TEST(MeshReader, DetectsTheFormatByExtension) {
  EXPECT_EQ(mesh_file_format("a/b.STL"), MeshFileFormat::kStl);
  EXPECT_EQ(mesh_file_format("b.ply"), MeshFileFormat::kPly);
  EXPECT_EQ(mesh_file_format("b.stl.obj"), MeshFileFormat::kObj);
  EXPECT_EQ(mesh_file_format("b.3MF"), MeshFileFormat::k3mf);
  EXPECT_EQ(mesh_file_format("b.glb"), MeshFileFormat::kGlb);
  EXPECT_FALSE(mesh_file_format("b.step"));
  EXPECT_FALSE(mesh_file_format("stl"));
}

TEST(MeshReader, MergesEqualVerticesAndDropsTrianglesWithoutThem) {
  const auto mesh = test::value_of(read(
      MeshFileFormat::kObj, "v 0 0 0\nv -0 0 0\nv 1 0 0\nv 0 1 0\nf 1 3 4\nf 2 3 1\nf 2 4 3\n"));
  EXPECT_EQ(mesh.vertices_mm.size(), 3U);
  EXPECT_EQ(mesh.triangles.size(), 2U);
}

/// Facets of a file, with each coordinate moved by at most `most_mm`.
std::string blurred_stl(const TriangleMesh& mesh, double most_mm, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> by(-most_mm, most_mm);
  std::ostringstream text;
  text.precision(17);
  text << "solid x\n";
  for (const auto& t : mesh.triangles) {
    text << "facet normal 0 0 0\nouter loop\n";
    for (const std::uint32_t v : t) {
      const Vec3 p = mesh.vertices_mm[v];
      text << "vertex " << p.x + by(random) << ' ' << p.y + by(random) << ' ' << p.z + by(random)
           << '\n';
    }
    text << "endloop\nendfacet\n";
  }
  text << "endsolid x\n";
  return text.str();
}

TEST(MeshReader, JoinsNearlyEqualVerticesAtOpenEdges) {
  const auto mesh = test::value_of(
      read(MeshFileFormat::kStl, written(ModelFormat::kStl, ModelEncoding::kBinary)));
  for (const double most_mm : {1e-15, 1e-9, 2e-6}) {
    const auto joined = test::value_of(read(MeshFileFormat::kStl, blurred_stl(mesh, most_mm, 4)));
    EXPECT_EQ(mesh_stock_fault(joined), "") << most_mm;
    EXPECT_LE(joined.triangles.size(), mesh.triangles.size());
    EXPECT_GE(joined.triangles.size(), mesh.triangles.size() * 99 / 100);
  }
  // A larger gap stays a fault, which names the edges.
  const auto apart = test::value_of(read(MeshFileFormat::kStl, blurred_stl(mesh, 0.01, 4)));
  EXPECT_NE(mesh_stock_fault(apart), "");
}

TEST(MeshReader, JoinsNothingInAClosedMesh) {
  // A slit of 1e-9 mm between two closed tetrahedra, in a mesh of 10 mm.
  std::string text =
      "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\n"
      "v 0 0 -1e-9\nv 10 0 -1e-9\nv 0 10 -1e-9\nv 0 0 -5\n"
      "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
      "f 5 6 7\nf 5 8 6\nf 6 8 7\nf 7 8 5\n";
  const auto mesh = test::value_of(read(MeshFileFormat::kObj, text));
  EXPECT_EQ(mesh_stock_fault(mesh), "");
  EXPECT_EQ(mesh.vertices_mm.size(), 8U);
  EXPECT_EQ(mesh.triangles.size(), 8U);
}

TEST(MeshReader, ReportsReasonAndLocation) {
  using enum MeshFileErrorCode;
  constexpr auto kObjFile = MeshFileFormat::kObj;
  EXPECT_EQ(code_of(kObjFile, "v 0 0\nv 1 0 0\n"), kSyntax);
  EXPECT_EQ(code_of(kObjFile, "v 0 0 nan\n"), kNotFinite);
  EXPECT_EQ(code_of(kObjFile, "v 0 0 0\nf 1 1\n"), kSyntax);
  EXPECT_EQ(code_of(kObjFile, "v 0 0 0\nf 1 2 3\n"), kBadIndex);
  EXPECT_EQ(code_of(kObjFile, "v 0 0 0\nf 0 1 1\n"), kBadIndex);
  EXPECT_EQ(code_of(kObjFile, "v 0 0 0\nf -2 1 1\n"), kBadIndex);
  EXPECT_EQ(code_of(kObjFile, "curv 0 1\n"), kSyntax);
  EXPECT_EQ(code_of(kObjFile, ""), kEmpty);
  EXPECT_EQ(code_of(kObjFile, "v 0 0 0\nf 1 1 1\n"), kEmpty);
  EXPECT_EQ(code_of(kObjFile, kObj, 5), kTooLarge);
  EXPECT_NE(read(kObjFile, "\n\nv 0 0 x\n").error().reason.find("line 3"), std::string::npos);
  constexpr auto kPlyFile = MeshFileFormat::kPly;
  EXPECT_EQ(code_of(kPlyFile, "plx"), kSyntax);
  EXPECT_EQ(code_of(kPlyFile, "ply\nformat binary_middle_endian 1.0\nend_header\n"), kUnsupported);
  EXPECT_EQ(code_of(kPlyFile, "ply\nformat ascii 1.0\nelement vertex x\nend_header\n"), kSyntax);
  EXPECT_EQ(code_of(kPlyFile, kAsciiPly, 5), kTooLarge);
  const auto changed = [](std::string_view from, std::string_view to) {
    std::string text = kAsciiPly;
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_EQ(code_of(kPlyFile, changed("double z", "double w")), kSyntax);
  EXPECT_EQ(code_of(kPlyFile, changed("3 3 0 4", "3 3 0 5")), kBadIndex);
  EXPECT_EQ(code_of(kPlyFile, changed("3 3 0 4", "3 3 -1 4")), kBadIndex);
  EXPECT_EQ(code_of(kPlyFile, changed("3 3 0 4", "-3 3 0 4")), kSyntax);
  EXPECT_EQ(code_of(kPlyFile, changed("1e0", "inf")), kNotFinite);
  EXPECT_NE(read(kPlyFile, changed("1e0", "one")).error().reason.find("vertex 4"),
            std::string::npos);
  const std::string binary = written(ModelFormat::kPly, ModelEncoding::kBinary);
  EXPECT_EQ(code_of(kPlyFile, binary + "x", 100'000), kCountMismatch);
  for (std::size_t bytes = 1; bytes < binary.size(); bytes += 97) {
    EXPECT_FALSE(read(kPlyFile, std::string_view(binary).substr(0, bytes)));
  }
}

TEST(MeshReader, RejectsDamagedFilesWithoutCrashing) {
  const std::vector<std::pair<MeshFileFormat, std::string>> files{
      {MeshFileFormat::kPly, kAsciiPly},
      {MeshFileFormat::kObj, kObj},
      {MeshFileFormat::kPly, written(ModelFormat::kPly, ModelEncoding::kBinary).substr(0, 4000)},
      {MeshFileFormat::kStl, written(ModelFormat::kStl, ModelEncoding::kAscii).substr(0, 4000)},
      {MeshFileFormat::kStl, written(ModelFormat::kStl, ModelEncoding::kBinary).substr(0, 4000)}};
  std::mt19937 random(17);
  for (const auto& [format, good] : files) {
    for (int n = 0; n < 3000; ++n) {
      std::string bad = good;
      for (unsigned k = 0; k <= random() % 4; ++k) {
        const std::size_t at = random() % bad.size();
        if (random() % 3 == 0) {
          bad.erase(at, random() % 9);
        } else {
          bad[at] = static_cast<char>(random());
        }
        if (bad.empty()) break;
      }
      const auto result = read(format, bad);
      if (!result) {
        EXPECT_FALSE(result.error().reason.empty());
        continue;
      }
      for (const auto& t : result->triangles) {
        for (const std::uint32_t v : t) ASSERT_LT(v, result->vertices_mm.size());
      }
      for (const Vec3& v : result->vertices_mm) ASSERT_TRUE(is_finite(v));
    }
  }
}

}  // namespace
}  // namespace kerf::mesh_reader_test
