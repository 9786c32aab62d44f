// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "server/wire/codec.h"
#include "tests/support/test.h"
#include "tests/wire/golden_json.h"

namespace kerf::wire::golden_test {
namespace {

using nlohmann::json;

std::filesystem::path golden_folder() {
  return std::filesystem::path(KERF_SOURCE_DIR) / "tests/wire/golden";
}

std::vector<std::byte> read_bytes(const std::string& name) {
  std::ifstream file(golden_folder() / name, std::ios::binary);
  EXPECT_TRUE(file) << name;
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

json read_index() {
  std::ifstream file(golden_folder() / "golden.json");
  return json::parse(file);
}

std::vector<std::byte> encode_again(const Message& message) {
  std::vector<std::byte> out;
  const FrameStamp& stamp = message.header.stamp;
  std::visit(
      [&]<typename Body>(const Body& body) {
        if constexpr (std::is_same_v<Body, MeshView>) {
          append(out, stamp, body, message.header.flags);
        } else if constexpr (!std::is_same_v<Body, UnknownBody>) {
          append(out, stamp, body);
        }
      },
      message.body);
  return out;
}

std::uint64_t durable_sequence(const Message& message) {
  if (const auto* result = std::get_if<Result>(&message.body)) return result->durable_sequence;
  if (const auto* pong = std::get_if<Pong>(&message.body)) return pong->durable_sequence;
  return 0;
}

TEST(WireGolden, DecodesEachFrameToItsDescription) {
  const json index = read_index();
  ASSERT_GE(index["frames"].size(), 11U);
  for (const json& expected : index["frames"]) {
    const std::string name = expected["file"];
    SCOPED_TRACE(name);
    const auto bytes = read_bytes(name);
    const auto message = test::value_of(decode(bytes));
    EXPECT_EQ(static_cast<int>(message.header.type), expected["type_number"]);
    EXPECT_EQ(message.header.flags, expected["flags"]);
    EXPECT_EQ(message.header.header_bytes, expected["header_bytes"]);
    EXPECT_EQ(message.header.payload_bytes, expected["payload_bytes"]);
    EXPECT_EQ(message.header.stamp.epoch, expected["epoch"]);
    EXPECT_EQ(message.header.stamp.sequence, expected["sequence"]);
    EXPECT_EQ(message.header.stamp.time_us, expected["time_us"]);
    EXPECT_EQ(describe(message), expected["body"]);
    EXPECT_EQ(durable_sequence(message), expected.value("durable_sequence", 0ULL));
  }
}

TEST(WireGolden, EncodesTheSameBytes) {
  const json index = read_index();
  for (const json& expected : index["frames"]) {
    const bool is_longer = expected["header_bytes"] != kHeaderBytes;
    if (expected["type"] == "unknown" || (is_longer && !expected.contains("durable_sequence"))) {
      continue;
    }
    const std::string name = expected["file"];
    SCOPED_TRACE(name);
    const auto bytes = read_bytes(name);
    EXPECT_EQ(encode_again(test::value_of(decode(bytes))), bytes);
  }
}

TEST(WireGolden, RejectsEachMalformedFrameWithItsCodeAndOffset) {
  const json index = read_index();
  ASSERT_GE(index["refused"].size(), 20U);
  for (const json& expected : index["refused"]) {
    const std::string name = expected["file"];
    SCOPED_TRACE(name);
    const auto error = test::error_of(decode(read_bytes(name)));
    EXPECT_EQ(code_name(error.code), expected["code"].get<std::string>());
    EXPECT_EQ(error.offset, expected["offset"]);
    EXPECT_FALSE(error.reason.empty());
  }
}

}  // namespace
}  // namespace kerf::wire::golden_test
