// SPDX-License-Identifier: Apache-2.0
#include "server/carve/tradeoff_options.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <iostream>

namespace kerf {
namespace {

constexpr std::size_t kSamplesMax = 10'000'000;
constexpr std::size_t kListMax = 32;

std::string check_positive(const std::string& text) {
  double value = 0;
  if (!CLI::detail::lexical_cast(text, value) || !std::isfinite(value) || value <= 0)
    return "must be a number > 0, not " + text;
  return {};
}

void declare(CLI::App& app, TradeoffOptions& options) {
  const auto list = [](CLI::Option* option) {
    option->delimiter(',')->expected(1, kListMax);
    return option;
  };
  app.add_option("--scene", options.scene, "scene: stock, tools, accuracy (JSON)")->required();
  app.add_option("--program", options.program, "NC program: .ngc .nc .tap .gcode, or .apt .cls")
      ->required();
  app.add_option("--csv", options.csv, "write the table as CSV");
  app.add_option("--svg", options.svg, "write a plot of error against time (SVG)");
  list(app.add_option("--pitches", options.pitches_mm,
                      "mm, separated by commas (default: 4, 2, 1 and 1/2 times that of the scene)"))
      ->check(check_positive);
  list(app.add_option("--tolerances", options.tolerances_mm,
                      "mm (default: 10, 1 and 1/10 times that of the scene)"))
      ->check(check_positive);
  list(app.add_option("--rays", options.rays, "dexel, tri-dexel (default: both)"))
      ->check(CLI::IsMember({"dexel", "tri-dexel"}));
  list(app.add_option("--motions", options.motions, "tight, paper (default: both)"))
      ->check(CLI::IsMember({"tight", "paper"}));
  app.add_option("--target", options.target_mm,
                 "mark the cheapest row with a surface error of at most MM")
      ->check(check_positive);
  app.add_option("--budget-seconds", options.budget_seconds,
                 "CPU time; configurations that exceed it are skipped and listed")
      ->check(check_positive)
      ->capture_default_str();
  app.add_option("--budget-mb", options.budget_mb, "largest stock in memory, MB")
      ->check(check_positive)
      ->capture_default_str();
  app.add_option("--samples", options.samples, "measured points of each surface")
      ->check(CLI::Range(std::size_t{100}, kSamplesMax))
      ->capture_default_str();
}

}  // namespace

std::variant<TradeoffOptions, int> parse_tradeoff_options(int argc, char** argv) {
  CLI::App app("Carves a program with many accuracy settings and compares their cost and error.",
               "kerf-carve tradeoff");
  TradeoffOptions options;
  declare(app, options);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    std::cerr << "kerf-carve tradeoff: " << error.what() << '\n';
    return 2;
  }
  return options;
}

}  // namespace kerf
