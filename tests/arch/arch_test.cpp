// SPDX-License-Identifier: Apache-2.0
// Checks the project's rules against the source tree.

#include "tests/arch/includes.h"
#include "tests/arch/modules.h"
#include "tests/arch/sizes.h"
#include "tests/arch/source.h"
#include "tests/arch/tokens.h"
#include "tests/arch/words.h"
#include "tests/support/test.h"

namespace kerf::arch::arch_test {
namespace {

const std::vector<Source>& tree() {
  static const std::vector<Source> kTree = load_tree(KERF_SOURCE_DIR);
  return kTree;
}

void report(const std::vector<Violation>& violations) {
  for (const Violation& v : violations) {
    ADD_FAILURE() << v.path << ":" << v.line << ": " << v.reason;
  }
}

template <typename Check>
void report_each(Check check) {
  ASSERT_FALSE(tree().empty()) << "no source below " KERF_SOURCE_DIR;
  for (const Source& source : tree()) report(check(source));
}

TEST(Arch, IncludesFollowTheDependencyTable) {
  std::set<std::string> paths;
  for (const Source& source : tree()) paths.insert(source.path);
  report_each([&](const Source& source) { return check_includes(source, paths); });
}

TEST(Arch, LinesFilesAndFunctionsAreWithinTheirLimits) { report_each(check_sizes); }

TEST(Arch, NoBannedTokenIsUsed) { report_each(check_tokens); }

TEST(Arch, NoRetiredWordIsUsed) { report_each(check_words); }

TEST(Arch, EveryFileIsBuiltDescribedAndTested) { report(check_modules(tree())); }

}  // namespace
}  // namespace kerf::arch::arch_test
