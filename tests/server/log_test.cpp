// SPDX-License-Identifier: Apache-2.0
#include "server/log/log.h"

#include <nlohmann/json.hpp>
#include <regex>

#include "tests/support/test.h"

namespace kerf::log_test {
namespace {

TEST(Log, WritesTimeLevelAndTextToStderr) {
  testing::internal::CaptureStderr();
  log::open();
  log::warn("session {} of {x}: 100 %");
  const std::string line = testing::internal::GetCapturedStderr();
  const std::regex expected(
      R"(\d{4}-\d\d-\d\d \d\d:\d\d:\d\d\.\d{3} \S*warning\S* session \{\} of \{x\}: 100 %\n)");
  EXPECT_TRUE(std::regex_match(line, expected)) << line;
}

TEST(Log, WritesOneJsonObjectPerLineIfAsked) {
  testing::internal::CaptureStderr();
  log::open(log::Format::kJson);
  log::error("file \"a\\b\"\nof {x}, \xC3\xA9");
  const std::string line = testing::internal::GetCapturedStderr();
  log::open();
  ASSERT_FALSE(line.empty());
  EXPECT_EQ(line.find('\n'), line.size() - 1);
  const auto json = nlohmann::json::parse(line);
  EXPECT_EQ(json.at("level"), "error");
  EXPECT_EQ(json.at("message"), "file \"a\\b\"\nof {x}, \xC3\xA9");
  EXPECT_TRUE(std::regex_match(json.at("time").get<std::string>(),
                               std::regex(R"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z)")));
}

}  // namespace
}  // namespace kerf::log_test
