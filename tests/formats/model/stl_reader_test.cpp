// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/stl_reader.h"

#include <unistd.h>

#include "server/formats/model/model_writer.h"
#include "tests/support/carvings.h"
#include "tests/support/test.h"

namespace kerf::stl_reader_test {
namespace {

namespace fs = std::filesystem;

std::vector<std::byte> bytes_of(std::string_view text) {
  const auto* first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

std::vector<std::byte> carved_block(unsigned seed) {
  static const BoxStock kBlock{{-6, 4, 2}, {8, 16, 9}};
  Sculpture sculpture = test::make_sculpture(kBlock, 0.4);
  test::RandomCarver carver(sculpture, kBlock.min_mm, kBlock.max_mm, seed);
  for (int n = 0; n < 20; ++n) carver.cut();
  const fs::path path = fs::path(::testing::TempDir()) / (std::to_string(::getpid()) + "_read.stl");
  SnapshotMesh mesh(sculpture.solid());
  EXPECT_TRUE(write_model(path, mesh, {.format = ModelFormat::kStl}));
  const std::string text = test::content_of(path);
  fs::remove(path);
  return bytes_of(text);
}

constexpr std::string_view kAscii =
    "solid a name with facet in it\n"
    "  facet normal 0 0 1\n    outer loop\n"
    "      vertex 0 0 0\n      vertex +1.5 0 0\n      vertex 0 1e1 -0.25\n"
    "    endloop\n  endfacet\nendsolid a name\n";

MeshFileErrorCode error_of(const std::vector<std::byte>& bytes, std::uint64_t facets_max = 1000) {
  const auto result = read_stl(bytes, facets_max);
  EXPECT_FALSE(result.has_value());
  if (result) return MeshFileErrorCode{99};
  EXPECT_FALSE(result.error().reason.empty());
  return result.error().code;
}

TEST(StlReader, ReadsAscii) {
  const auto triangles = test::value_of(read_stl(bytes_of(kAscii)));
  ASSERT_EQ(triangles.size(), 1U);
  EXPECT_EQ((triangles)[0][1], (Vec3{1.5, 0, 0}));
  EXPECT_EQ((triangles)[0][2], (Vec3{0, 10, -0.25}));
  std::string other(kAscii);
  std::ranges::replace(other, '\n', '\r');
  other.replace(other.find("+1.5"), 4, "1E-400");
  const auto again = read_stl(bytes_of(other));
  ASSERT_TRUE(again) << again.error().reason << ", lines that end with CR";
  EXPECT_EQ((*again)[0][1], (Vec3{0, 0, 0})) << "too small for a double";
}

TEST(StlReader, AcceptsMixedLineEndings) {
  const auto plain = test::value_of(read_stl(bytes_of(kAscii)));
  const std::array<std::string, 3> ends{"\r", "\n", "\r\n"};
  // All combinations of line ends for the first two lines, the last one and those between.
  for (unsigned n = 0; n < 81; ++n) {
    std::string text;
    unsigned line = 0;
    for (const char c : kAscii) {
      if (c != '\n') {
        text += c;
        continue;
      }
      const unsigned kind = line == 0                ? n
                            : line == 1              ? n / 3
                            : text.ends_with("name") ? n / 9
                                                     : n / 27;
      text += ends.at(kind % 3);
      ++line;
    }
    const auto read = read_stl(bytes_of(text));
    ASSERT_TRUE(read) << read.error().reason << ", " << n;
    EXPECT_EQ(*read, plain);
    text.insert(text.find("+1.5"), "x");
    const auto error = test::error_of(read_stl(bytes_of(text)));
    EXPECT_TRUE(error.reason.starts_with("line 5:")) << error.reason << ", " << n;
  }
}

TEST(StlReader, ReadsABinaryFileWhoseTitleStartsWithSolid) {
  std::vector<std::byte> bytes = carved_block(6);
  std::memcpy(bytes.data(), "solid", 5);
  EXPECT_EQ(stl_file_bytes(test::value_of(read_stl(bytes)).size()), bytes.size());
}

TEST(StlReader, RejectsATruncatedFileAtEveryLength) {
  std::vector<std::byte> bytes = carved_block(6);
  bytes.resize(84 + 50 * 3);
  bytes[80] = std::byte{3};
  bytes[81] = bytes[82] = bytes[83] = std::byte{0};
  ASSERT_TRUE(read_stl(bytes));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_EQ(error_of({bytes.begin(), bytes.begin() + std::ptrdiff_t(size)}),
              MeshFileErrorCode::kTruncated);
  }
  for (std::size_t size = 0; size < kAscii.size() - 20; ++size) {
    const auto result = read_stl(bytes_of(kAscii.substr(0, size)));
    EXPECT_FALSE(result) << size;
  }
}

TEST(StlReader, ReportsTheReason) {
  std::vector<std::byte> bytes(84 + 50, std::byte{0});
  bytes[80] = std::byte{1};
  EXPECT_TRUE(read_stl(bytes));
  auto longer = bytes;
  longer.push_back(std::byte{0});
  EXPECT_EQ(error_of(longer), MeshFileErrorCode::kCountMismatch);
  EXPECT_EQ(error_of(bytes, 0), MeshFileErrorCode::kTooLarge);
  auto empty = bytes;
  empty[80] = std::byte{0};
  EXPECT_EQ(error_of(empty), MeshFileErrorCode::kEmpty);
  auto nan = bytes;
  const auto bits =
      std::bit_cast<std::array<std::byte, 4>>(std::numeric_limits<float>::quiet_NaN());
  std::copy(bits.begin(), bits.end(), nan.begin() + 84 + 12 + 4);
  EXPECT_EQ(error_of(nan), MeshFileErrorCode::kNotFinite);
  EXPECT_NE(read_stl(nan).error().reason.find("facet 1"), std::string::npos);
}

TEST(StlReader, ReportsTheLineOfAnAsciiError) {
  std::string text(kAscii);
  text.replace(text.find("+1.5"), 4, "one!");
  const auto error = test::error_of(read_stl(bytes_of(text)));
  EXPECT_EQ(error.code, MeshFileErrorCode::kSyntax);
  EXPECT_NE(error.reason.find("line 5"), std::string::npos) << error.reason;
  std::string infinite(kAscii);
  infinite.replace(infinite.find("1e1"), 3, "inf");
  EXPECT_EQ(error_of(bytes_of(infinite)), MeshFileErrorCode::kNotFinite);
  EXPECT_EQ(error_of(bytes_of("solid x\nendsolid x\n")), MeshFileErrorCode::kEmpty);
  EXPECT_EQ(error_of(bytes_of(kAscii), 0), MeshFileErrorCode::kTooLarge);
}

}  // namespace
}  // namespace kerf::stl_reader_test
