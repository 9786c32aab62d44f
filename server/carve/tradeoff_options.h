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

/// The command line of `kerf-carve tradeoff`. An empty list means values around those of the scene.
struct TradeoffOptions {
  std::filesystem::path scene, program;
  std::optional<std::filesystem::path> csv, svg;
  std::vector<double> pitches_mm, tolerances_mm;
  std::vector<std::string> rays, motions;
  std::optional<double> target_mm;  ///< marks the cheapest row that meets it
  double budget_seconds = 600;
  double budget_mb = 4096;  ///< memory of the stock of one configuration if all of it is touched
  std::size_t samples = 10000;
};

/// Parses the command line from the word "tradeoff" on. Returns the options, or the exit status if
/// there is nothing more to do.
std::variant<TradeoffOptions, int> parse_tradeoff_options(int argc, char** argv);

}  // namespace kerf
