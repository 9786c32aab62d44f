// SPDX-License-Identifier: Apache-2.0
#include "server/log/log.h"

#include <gtest/gtest.h>

#include <regex>

namespace kerf {
namespace {

TEST(Log, WritesTheTextAsItIsWithTimeAndLevelOnStderr) {
  testing::internal::CaptureStderr();
  log::open();
  log::warn("session {} of {x}: 100 %");
  const std::string line = testing::internal::GetCapturedStderr();
  const std::regex expected(
      R"(\d{4}-\d\d-\d\d \d\d:\d\d:\d\d\.\d{3} \S*warning\S* session \{\} of \{x\}: 100 %\n)");
  EXPECT_TRUE(std::regex_match(line, expected)) << line;
}

}  // namespace
}  // namespace kerf
