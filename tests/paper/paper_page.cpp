// SPDX-License-Identifier: Apache-2.0
// Writes the page of the paper. Usage: paper_page [FOLDER=tests/paper]. Exits with 1 if a row
// fails.

#include <cstdio>
#include <filesystem>
#include <fstream>

#include "server/picture/png_file.h"
#include "tests/paper/figures.h"
#include "tests/paper/page.h"
#include "tests/paper/volume_checks.h"
#include "tests/paper/voxel_checks.h"

int main(int argc, char** argv) {
  using namespace kerf;
  constexpr int kRounds = 5;
  const std::filesystem::path folder = argc > 1 ? argv[1] : "tests/paper";
  for (const paper::Figure& figure : paper::figures()) {
    const auto written = write_png(folder / (figure.file + ".png"), figure.draw());
    if (!written) return std::fprintf(stderr, "paper_page: %s\n", written.error().c_str()), 1;
  }
  int failed = 0;
  const std::string page = paper::page_text(paper::run_tests, failed);
  const std::string times =
      "\n## Times\n\nOf one run, CPU time, best of 5 (models: of 2), both in turn: ratios are more "
      "reliable than\ntimes. Voxels and dexels, 300 ramps:\n\n" +
      paper::voxel_times(kRounds) + "\nThe two models, eleven tools, one motion each:\n\n" +
      paper::kinds_times(2);
  std::fputs(page.substr(page.find("## Claims")).c_str(), stdout);
  std::fputs(times.c_str(), stdout);
  std::ofstream out(folder / "page.md");
  out << page;
  if (!out.flush()) return std::fprintf(stderr, "paper_page: cannot write page.md\n"), 1;
  return failed == 0 ? 0 : 1;
}
