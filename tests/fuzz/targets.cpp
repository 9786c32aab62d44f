// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/targets.h"

#include <cstdio>
#include <cstdlib>

namespace kerf::fuzz {

std::span<const Target> targets() {
  static constexpr Target kTargets[] = {
      {"wire", read_wire},    {"columns", read_columns}, {"control", read_control},
      {"gcode", read_gcode},  {"apt", read_apt},         {"tables", read_tables},
      {"scene", read_scene},  {"mesh", read_mesh},       {"batch", read_batch},
      {"http", read_request}, {"journal", read_journal}, {"snapshot", read_snapshot},
      {"tile", read_tile},    {"conversation", converse}};
  return kTargets;
}

void require(bool holds, const char* property) {
  if (holds) return;
  std::fprintf(stderr, "the property does not hold: %s\n", property);
  std::abort();
}

}  // namespace kerf::fuzz
