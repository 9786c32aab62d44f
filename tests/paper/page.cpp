// SPDX-License-Identifier: Apache-2.0
#include "tests/paper/page.h"

#include <array>
#include <cstdio>
#include <map>
#include <set>

#include "tests/paper/check.h"
#include "tests/paper/figures.h"
#include "tests/paper/volume_checks.h"
#include "tests/paper/voxel_checks.h"

namespace kerf::paper {
namespace {

struct Ran {
  int status = -1;
  std::string output;
};

Ran run(const Row& row, const std::string& options) {
  const std::string command = KERF_TESTS_FOLDER "/" + row.program +
                              " '--gtest_filter=" + row.check + "' " + options + " 2>&1";
  std::FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return {};
  Ran ran;
  std::array<char, 4096> part{};
  while (const std::size_t size = std::fread(part.data(), 1, part.size(), pipe)) {
    ran.output.append(part.data(), size);
  }
  ran.status = pclose(pipe);
  return ran;
}

/// Returns a text with its lines wrapped at 100 columns.
std::string wrapped(std::string text) {
  std::size_t begin = 0;
  while (text.size() - begin > 100) {
    const std::size_t gap = text.rfind(' ', begin + 100);
    text[gap] = '\n';
    begin = gap + 1;
  }
  return text;
}

/// `shown`: the checks whose figures an earlier row has.
std::string row_text(const Row& row, const RunTests& run_tests, std::set<std::string>& shown,
                     int& failed) {
  std::string by = "–";
  if (!row.check.empty()) {
    const bool holds = row.program.empty() ? found(row.check).holds : run_tests(row);
    failed += holds ? 0 : 1;
    by = holds ? "" : "**FAIL** ";
    by += row.program.empty() ? "`PaperCheck/" + row.check + "`" : "`" + row.check + "`";
    if (row.program.empty() && !found(row.check).figures.empty()) {
      by += shown.insert(row.check).second ? ": " + found(row.check).figures : ", as above";
    }
  }
  return "| " + row.place + " | " + row.states + " | " + row.where + " | " + by + " | " +
         row.deviates + " |\n";
}

}  // namespace

bool run_tests(const Row& row) {
  static std::map<std::string, bool> results;
  const auto known = results.find(row.program + row.check);
  if (known != results.end()) return known->second;
  const Ran ran = run(row, "--gtest_brief=1");
  const bool some = ran.output.find("[  PASSED  ] 0 tests") == std::string::npos &&
                    ran.output.find("[  PASSED  ]") != std::string::npos;
  return results[row.program + row.check] = ran.status == 0 && some;
}

bool has_tests(const Row& row) {
  const Ran ran = run(row, "--gtest_list_tests");
  return ran.status == 0 && ran.output.find("\n  ") != std::string::npos;
}

std::string page_text(const RunTests& run_tests, int& failed) {
  std::string page =
      "# The paper on one page\n\n"
      "Zhu & Lee, *Dexel-based force–torque rendering and volume updating*, 2004: its figures, "
      "made\n"
      "again by Kerf with scenes of our own, and its claims, equations and figures, each with the\n"
      "check that reproduces it. Written by `paper_page` ([README.md](README.md)).\n\n## "
      "Figures\n\n";
  for (const Figure& figure : figures()) {
    page += wrapped("**" + figure.place + ".** " + figure.caption) + "\n\n![" + figure.place +
            "](" + figure.file + ".png)\n\n";
  }
  std::string table;
  std::set<std::string> shown;
  int count = 0, without = 0;
  failed = 0;
  for (const Row& row : rows()) {
    table += row_text(row, run_tests, shown, failed);
    ++count;
    without += row.check.empty() ? 1 : 0;
  }
  page += "## Claims, equations and figures\n\n" +
          text("%d rows: %d pass, %d fail, %d cannot be reproduced here.\n\n", count,
               count - failed - without, failed, without) +
          "| paper | states | implemented in | reproduced by | deviates, why |\n"
          "|---|---|---|---|---|\n" +
          table;
  page +=
      "\n## Dexels and voxels of equal accuracy\n\n"
      "300 ramps of a ball and a flat mill in a block of 24 × 24 × 20 mm. The error is the "
      "greatest\n"
      "distance of the end of a column from the true surface, along the ray. A voxel has one bit.\n"
      "Upper rows: columns as fine as the voxels; lower rows: columns 0.25 mm apart.\n\n" +
      voxel_table();
  page +=
      "\n## Four kinds of motion, two models\n\n"
      "One motion of each kind, by eleven tools: the worst error, and the mean number of "
      "cuts.\n\n" +
      kinds_table();
  return page;
}

}  // namespace kerf::paper
