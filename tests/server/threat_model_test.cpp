// SPDX-License-Identifier: Apache-2.0
#include "tests/support/test.h"

namespace kerf::threat_model_test {
namespace {

std::string all_tests() {
  std::string text;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(KERF_SOURCE_DIR "/tests")) {
    const auto& path = entry.path();
    if (path.string().contains("node_modules")) continue;
    if (path.extension() == ".cpp" || path.extension() == ".py") text += test::content_of(path);
  }
  return text;
}

/// Whether a test "Suite.Name" of GoogleTest, or "test_name" of Python, is defined.
bool exists(const std::string& name, const std::string& tests) {
  const auto dot = name.find('.');
  if (dot == name.npos) return tests.contains("def " + name + "(");
  const std::string head = "(" + name.substr(0, dot) + ",";
  for (auto at = tests.find(head); at != tests.npos; at = tests.find(head, at + 1)) {
    const auto word = tests.find_first_not_of(" \n", at + head.size());
    if (tests.compare(word, name.size() - dot, name.substr(dot + 1) + ")") == 0) return true;
  }
  return false;
}

TEST(ThreatModel, EveryNamedTestExists) {
  const std::string tests = all_tests();
  std::istringstream model(test::content_of(KERF_SOURCE_DIR "/server/SECURITY.md"));
  int rows = 0;
  for (std::string line; std::getline(model, line);) {
    if (!line.starts_with("| ") || line.starts_with("| asset")) continue;
    ++rows;
    const auto column = line.rfind('|', line.size() - 2);
    int names = 0;
    for (auto open = line.find('`', column); open != line.npos;) {
      const auto close = line.find('`', open + 1);
      ASSERT_NE(close, line.npos) << line;
      const std::string name = line.substr(open + 1, close - open - 1);
      EXPECT_TRUE(exists(name, tests)) << "no test is named " << name;
      ++names;
      open = line.find('`', close + 1);
    }
    EXPECT_GT(names, 0) << "no test in " << line;
  }
  EXPECT_GT(rows, 15);
}

TEST(ThreatModel, UnknownTestNameIsDetected) {
  const std::string tests = "TEST(Suite, Name) {}\n  def test_name(self):";
  EXPECT_TRUE(exists("Suite.Name", tests));
  EXPECT_TRUE(exists("test_name", tests));
  EXPECT_FALSE(exists("Suite.Nam", tests));
  EXPECT_FALSE(exists("Suite.Other", tests));
  EXPECT_FALSE(exists("test_nam", tests));
}

}  // namespace
}  // namespace kerf::threat_model_test
