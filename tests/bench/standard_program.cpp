// SPDX-License-Identifier: Apache-2.0
// Prints the standard job as an APT program; its scene is tests/formats/scenes/standard.json.
// Usage: standard_program 3|5 > job.apt

#include <cstdio>
#include <string_view>

#include "tests/support/standard_job.h"

int main(int argc, char** argv) {
  const bool five_axis = argc > 1 && std::string_view(argv[1]) == "5";
  std::printf("PARTNO/STANDARD JOB\nUNITS/MM\nMULTAX/ON\nLOADTL/1\nFEDRAT/6000,MMPM\n");
  for (const kerf::ToolPose& pose : kerf::test::standard_path(five_axis)) {
    const auto [p, u] = pose;
    std::printf("GOTO/%.6f,%.6f,%.6f,%.15f,%.15f,%.15f\n", p.x, p.y, p.z, u.x, u.y, u.z);
  }
  std::printf("FINI\n");
  return 0;
}
