// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "kernel/sculpture.h"

namespace kerf {

/// What `kerf-carve tradeoff` is asked for. An empty list stands for values around the scene's own.
struct TradeoffOptions {
  std::filesystem::path scene, program;
  std::optional<std::filesystem::path> csv, svg;
  std::vector<double> pitches_mm, tolerances_mm;
  std::vector<std::string> rays, motions;
  std::optional<double> target_mm;  ///< marks the cheapest that meets it
  double budget_seconds = 600;
  double budget_mb = 4096;  ///< of one configuration's stock, were it all touched
  std::size_t samples = 10000;
};

/// The options, or the exit status where the command line has been answered already. `argv` starts
/// at the word "tradeoff".
std::variant<TradeoffOptions, int> parse_tradeoff_options(int argc, char** argv);

}  // namespace kerf
