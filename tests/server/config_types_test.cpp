// SPDX-License-Identifier: Apache-2.0
#include "server/config_types.h"

#include "tests/support/test.h"

namespace kerf::config_types_test {
namespace {

ConfigType type_of(std::string_view key) {
  if (key == "open") return ConfigType::kBoolean;
  if (key == "disk") return ConfigType::kNumber;
  if (key == "listen") return ConfigType::kText;
  if (key == "hosts") return ConfigType::kTexts;
  return ConfigType::kUnknown;
}

/// Returns "LINE: REASON", or "none".
std::string fault(std::string_view text) {
  const auto found = check_types(text, type_of);
  return found ? std::to_string(found->line) + ": " + found->reason : "none";
}

TEST(ConfigTypes, ValidValuesAreAccepted) {
  EXPECT_EQ(fault(""), "none");
  EXPECT_EQ(fault("# comment\n\n; comment\nopen = true\nopen=false # why\n"), "none");
  EXPECT_EQ(fault("disk = 5\ndisk = -2.5e3\n\tdisk\t=\t0 # MB\r\n"), "none");
  EXPECT_EQ(fault("listen = \"a:1\" # b\nlisten = 'a'\nlisten = \"\"\n\"listen\" = \"a\""), "none");
  EXPECT_EQ(fault("hosts = \"a\"\nhosts = []\nhosts = [\"a\", 'b',\n \"c\",\n]\nopen = true"),
            "none");
  EXPECT_EQ(fault("another = yes\n[section]\nopen = \"yes\"\n"), "none") << "not of this check";
}

TEST(ConfigTypes, AFaultNamesItsLineItsKeyAndTheType) {
  EXPECT_EQ(fault("\nopen = \"yes\""), "2: open must be true or false, without quotes");
  EXPECT_EQ(fault("open = yes"), "1: open must be true or false, without quotes");
  EXPECT_EQ(fault("open = 1"), "1: open must be true or false, without quotes");
  EXPECT_EQ(fault("open"), "1: open has no value: write KEY = VALUE");
  EXPECT_EQ(fault("open ="), "1: open has no value");
  EXPECT_EQ(fault("disk = \"5\""), "1: disk must be a number, without quotes");
  EXPECT_EQ(fault("disk = 5 MB"), "1: disk must be a number, without quotes");
  EXPECT_EQ(fault("listen = a:1"), "1: listen must be a text in quotes");
  EXPECT_EQ(fault("listen = [\"a\"]"), "1: listen must be a text in quotes");
  EXPECT_EQ(fault("[default]\nhosts = 7"),
            "2: hosts must be a list of texts in quotes, or one text");
  EXPECT_EQ(fault("hosts = [\"a\",\n b]\n"), "1: hosts must be a list of texts, each in quotes");
  EXPECT_EQ(fault("hosts = [\"a\" \"b\"]"),
            "1: hosts must be a list of texts, with commas between them");
}

TEST(ConfigTypes, AmbiguousValuesAreFaults) {
  EXPECT_EQ(fault("listen = \"a"), "1: listen has quotes that are not closed");
  EXPECT_EQ(fault("listen = \"a\" b"), "1: listen has something behind its value");
  EXPECT_EQ(fault("listen = \"a#b\""),
            "1: listen may not contain #: what follows would be a comment");
  EXPECT_EQ(fault("hosts = [\"a\"\nopen = true\n"),
            "1: hosts has a list that is not closed with ] at the end of a line");
}

}  // namespace
}  // namespace kerf::config_types_test
