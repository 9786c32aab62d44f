#include "server/formats/stl.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>

#include "tests/support/carvings.h"

namespace kerf {
namespace {

namespace fs = std::filesystem;

std::vector<std::byte> bytes_of(std::string_view text) {
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

std::vector<std::byte> all_bytes(StlStream& stream) {
  std::vector<std::byte> all, chunk;
  while (stream.next(chunk)) all.insert(all.end(), chunk.begin(), chunk.end());
  EXPECT_TRUE(chunk.empty());
  return all;
}

DexelSnapshot carved_block(unsigned seed) {
  static const BoxStock kBlock{{-6, 4, 2}, {8, 16, 9}};
  Sculpture sculpture = test::make_sculpture(kBlock, 0.4);
  test::RandomCarver carver(sculpture, kBlock.min_mm, kBlock.max_mm, seed);
  for (int n = 0; n < 20; ++n) carver.cut();
  return sculpture.snapshot();
}

fs::path scratch_file(const char* name) {
  return fs::path(::testing::TempDir()) / (std::to_string(::getpid()) + name);
}

constexpr std::string_view kAscii =
    "solid a name with facet in it\n"
    "  facet normal 0 0 1\n    outer loop\n"
    "      vertex 0 0 0\n      vertex +1.5 0 0\n      vertex 0 1e1 -0.25\n"
    "    endloop\n  endfacet\nendsolid a name\n";

StlErrorCode error_of(const std::vector<std::byte>& bytes, std::uint64_t facets_max = 1000) {
  const auto result = read_stl(bytes, facets_max);
  EXPECT_FALSE(result.has_value());
  if (result) return StlErrorCode::kCannotWrite;
  EXPECT_FALSE(result.error().reason.empty());
  return result.error().code;
}

TEST(StlStream, KnowsItsLengthBeforeTheFirstByteAndReadsBackEqual) {
  const DexelSnapshot snapshot = carved_block(3);
  StlStream stream(snapshot, "solid as a rock");
  const std::uint64_t announced = stream.total_bytes();
  const std::vector<std::byte> bytes = all_bytes(stream);
  ASSERT_EQ(bytes.size(), announced);
  EXPECT_NE(std::string_view(reinterpret_cast<const char*>(bytes.data()), 5), "solid");
  const auto triangles = read_stl(bytes);
  ASSERT_TRUE(triangles) << triangles.error().reason;
  EXPECT_EQ(triangles->size(), stream.facets());
  double volume = 0;
  for (const StlTriangle& t : *triangles) {
    volume += dot(t[0], cross(t[1], t[2])) / 6;
    for (const Vec3& corner : t) {
      EXPECT_GE(corner.x, -6);
      EXPECT_LE(corner.z, 9);
    }
  }
  EXPECT_NEAR(volume, snapshot.volume_mm3(), 0.03 * snapshot.volume_mm3());
}

TEST(StlFile, IsTheSameAsTheStreamAndLeavesNoPart) {
  const DexelSnapshot snapshot = carved_block(4);
  const fs::path path = scratch_file("_equal.stl");
  double last = 0;
  const auto summary =
      write_stl_file(path, snapshot, "block", [&last](double share) { last = share; });
  ASSERT_TRUE(summary) << summary.error().reason;
  EXPECT_EQ(last, 1);
  StlStream stream(snapshot, "block");
  const auto expected = all_bytes(stream);
  EXPECT_EQ(summary->bytes, expected.size());
  std::ifstream file(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  EXPECT_EQ(bytes_of(text), expected);
  EXPECT_FALSE(fs::exists(path.string() + ".part"));
  fs::remove(path);
}

TEST(StlFile, SaysThatItCannotWriteAndLeavesNothing) {
  const fs::path path = scratch_file("_no_such_folder") / "a.stl";
  const auto summary = write_stl_file(path, carved_block(5), "block");
  ASSERT_FALSE(summary);
  EXPECT_EQ(summary.error().code, StlErrorCode::kCannotWrite);
  EXPECT_NE(summary.error().reason.find("a.stl"), std::string::npos);
  EXPECT_FALSE(fs::exists(path));
}

TEST(StlFile, SatisfiesAdmesh) {
  if (std::system("command -v admesh > /dev/null 2>&1") != 0) GTEST_SKIP() << "admesh is not here";
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const fs::path path = scratch_file("_admesh.stl");
    ASSERT_TRUE(write_stl_file(path, carved_block(seed), "block"));
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

TEST(StlReader, ReadsAscii) {
  const auto triangles = read_stl(bytes_of(kAscii));
  ASSERT_TRUE(triangles) << triangles.error().reason;
  ASSERT_EQ(triangles->size(), 1U);
  EXPECT_EQ((*triangles)[0][1], (Vec3{1.5, 0, 0}));
  EXPECT_EQ((*triangles)[0][2], (Vec3{0, 10, -0.25}));
}

TEST(StlReader, ReadsABinaryFileWhoseTitleStartsWithSolid) {
  StlStream stream(carved_block(6), "block");
  std::vector<std::byte> bytes = all_bytes(stream);
  std::memcpy(bytes.data(), "solid", 5);
  const auto triangles = read_stl(bytes);
  ASSERT_TRUE(triangles) << triangles.error().reason;
  EXPECT_EQ(triangles->size(), stream.facets());
}

TEST(StlReader, RefusesATruncatedFileAtEveryLength) {
  StlStream stream(carved_block(6), "block");
  std::vector<std::byte> bytes = all_bytes(stream);
  bytes.resize(84 + 50 * 3);
  bytes[80] = std::byte{3};
  bytes[81] = bytes[82] = bytes[83] = std::byte{0};
  ASSERT_TRUE(read_stl(bytes));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_EQ(error_of({bytes.begin(), bytes.begin() + std::ptrdiff_t(size)}),
              StlErrorCode::kTruncated);
  }
  for (std::size_t size = 0; size < kAscii.size() - 20; ++size) {
    const auto result = read_stl(bytes_of(kAscii.substr(0, size)));
    EXPECT_FALSE(result) << size;
  }
}

TEST(StlReader, NamesWhatIsWrong) {
  std::vector<std::byte> bytes(84 + 50, std::byte{0});
  bytes[80] = std::byte{1};
  EXPECT_TRUE(read_stl(bytes));
  auto longer = bytes;
  longer.push_back(std::byte{0});
  EXPECT_EQ(error_of(longer), StlErrorCode::kCountMismatch);
  EXPECT_EQ(error_of(bytes, 0), StlErrorCode::kTooLarge);
  auto empty = bytes;
  empty[80] = std::byte{0};
  EXPECT_EQ(error_of(empty), StlErrorCode::kEmpty);
  auto nan = bytes;
  const auto bits =
      std::bit_cast<std::array<std::byte, 4>>(std::numeric_limits<float>::quiet_NaN());
  std::copy(bits.begin(), bits.end(), nan.begin() + 84 + 12 + 4);
  EXPECT_EQ(error_of(nan), StlErrorCode::kNotFinite);
  EXPECT_NE(read_stl(nan).error().reason.find("facet 1"), std::string::npos);
}

TEST(StlReader, NamesTheLineOfAnAsciiError) {
  std::string text(kAscii);
  text.replace(text.find("+1.5"), 4, "one!");
  const auto result = read_stl(bytes_of(text));
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, StlErrorCode::kSyntax);
  EXPECT_NE(result.error().reason.find("line 5"), std::string::npos) << result.error().reason;
  std::string infinite(kAscii);
  infinite.replace(infinite.find("1e1"), 3, "inf");
  EXPECT_EQ(error_of(bytes_of(infinite)), StlErrorCode::kNotFinite);
  EXPECT_EQ(error_of(bytes_of("solid x\nendsolid x\n")), StlErrorCode::kEmpty);
  EXPECT_EQ(error_of(bytes_of(kAscii), 0), StlErrorCode::kTooLarge);
}

}  // namespace
}  // namespace kerf
