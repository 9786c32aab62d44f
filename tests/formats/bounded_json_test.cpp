// SPDX-License-Identifier: Apache-2.0
#include "server/formats/bounded_json.h"

#include <nlohmann/json.hpp>

#include "tests/support/test.h"

namespace kerf::bounded_json_test {
namespace {

using Json = nlohmann::json;

const Json& document(const JsonDocument& read) { return *static_cast<const Json*>(read.get()); }

std::string nested(int depth, const std::string& open, const std::string& inner,
                   const std::string& close) {
  std::string text;
  for (int n = 0; n < depth; ++n) text += open;
  text += inner;
  for (int n = 0; n < depth; ++n) text += close;
  return text;
}

JsonFaultKind fault_of(const std::string& text, const JsonRules& rules = {}) {
  const auto read = parse_bounded_json(text, rules);
  EXPECT_FALSE(read) << text.substr(0, 80);
  return read ? JsonFaultKind::kStopped : read.error().kind;
}

/// A document of any kind of value, without repeated keys.
Json random_value(std::mt19937& random, int depth) {
  const auto kind = random() % (depth > 0 ? 8 : 6);
  if (kind == 0) return nullptr;
  if (kind == 1) return random() % 2 == 0;
  if (kind == 2) return -static_cast<int>(random() % 1000);
  if (kind == 3) return random();
  if (kind == 4) return static_cast<double>(random()) / 7;
  if (kind == 5) return std::string(random() % 20, 'x') + "\n\"\xc3\xa4";
  Json container = kind == 6 ? Json::array() : Json::object();
  for (auto n = random() % 6; n > 0; --n) {
    if (kind == 6) container.push_back(random_value(random, depth - 1));
    if (kind == 7) container["key " + std::to_string(n)] = random_value(random, depth - 1);
  }
  return container;
}

TEST(BoundedJson, AgreesWithTheLibrary) {
  std::mt19937 random(7);
  for (int n = 0; n < 500; ++n) {
    const Json value = random_value(random, 6);
    const std::string text = value.dump(n % 3 - 1);
    const auto read = parse_bounded_json(text, {});
    ASSERT_TRUE(read) << text;
    EXPECT_EQ(document(*read), Json::parse(text)) << text;
  }
}

TEST(BoundedJson, NamesTheByteOfASyntaxError) {
  const auto error = test::error_of(parse_bounded_json("{\"a\": 1,\n ]", {}));
  EXPECT_EQ(error.kind, JsonFaultKind::kSyntax);
  EXPECT_EQ(error.byte, 10U);
  for (const char* text : {"", "{", "[1,]", "{\"a\" 1}", "1 2", "nul", "[\"\xff\"]"})
    EXPECT_EQ(fault_of(text), JsonFaultKind::kSyntax) << text;
}

TEST(BoundedJson, ANumberBeyondADoubleIsOutOfRange) {
  EXPECT_EQ(fault_of("[1e999]"), JsonFaultKind::kRange);
}

TEST(BoundedJson, ARepeatedKeyIsAnErrorOfItsObjectOnly) {
  const auto error =
      test::error_of(parse_bounded_json(R"({"a": {"b": 1}, "c": {"b": 2, "b": 3}})", {}));
  EXPECT_EQ(error.kind, JsonFaultKind::kRepeatedKey);
  EXPECT_EQ(error.key, "b");
  const auto last = test::value_of(
      parse_bounded_json(R"({"b": {"x": 1}, "b": 3})", {.takes_repeated_keys = true}));
  EXPECT_EQ(document(last), Json({{"b", 3}}));
}

TEST(BoundedJson, NestsAsDeepAsTheLimitAndNoDeeper) {
  for (const int most : {1, 2, 32}) {
    const JsonRules rules{.depth_max = most};
    EXPECT_TRUE(parse_bounded_json(nested(most, "[", "1", "]"), rules)) << most;
    EXPECT_TRUE(parse_bounded_json(nested(most, "{\"a\":", "1", "}"), rules)) << most;
    EXPECT_EQ(fault_of(nested(most + 1, "[", "1", "]"), rules), JsonFaultKind::kTooDeep);
    EXPECT_EQ(fault_of(nested(most + 1, "{\"a\":", "1", "}"), rules), JsonFaultKind::kTooDeep);
  }
  // The reader stops at the depth limit, not at the end of a text of opening brackets.
  EXPECT_EQ(fault_of(std::string(1 << 20, '[')), JsonFaultKind::kTooDeep);
}

TEST(BoundedJson, DropsDeeperValues) {
  const auto read =
      test::value_of(parse_bounded_json(R"({"a": [1, {"x": [2, {}]}, 3], "b": {"c": {"d": 4}}})",
                                        {.depth_max = 2, .drops_deeper = true}));
  EXPECT_EQ(document(read).dump(), R"({"a":[],"b":{}})");
  const auto deep = parse_bounded_json(nested(100'000, "{\"a\":[", "1", "]}"),
                                       {.depth_max = 32, .drops_deeper = true});
  ASSERT_TRUE(deep);
  EXPECT_EQ(fault_of(nested(50, "[", "", "") + "}", {.depth_max = 2, .drops_deeper = true}),
            JsonFaultKind::kSyntax);
}

TEST(BoundedJson, KeepsAtMostTheLimitOfValues) {
  const JsonRules rules{.values_max = 4};
  EXPECT_TRUE(parse_bounded_json("[1, 2, {}]", rules));
  EXPECT_EQ(fault_of("[1, 2, {}, 3]", rules), JsonFaultKind::kTooMany);
  // Dropped values take no memory.
  EXPECT_TRUE(parse_bounded_json("[[[1, 2, 3, 4, 5], 6], 7]",
                                 {.depth_max = 2, .drops_deeper = true, .values_max = 4}));
}

TEST(BoundedJson, StopsOnRequest) {
  bool stops = false;
  std::string text = "[";
  for (int n = 0; n < 10'000; ++n) text += "1,";
  text += "1]";
  const JsonRules rules{.is_stopped = [&stops] { return stops; }};
  EXPECT_TRUE(parse_bounded_json(text, rules));
  stops = true;
  EXPECT_EQ(fault_of(text, rules), JsonFaultKind::kStopped);
}

}  // namespace
}  // namespace kerf::bounded_json_test
