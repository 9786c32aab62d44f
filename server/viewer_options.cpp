// SPDX-License-Identifier: Apache-2.0
#include "server/viewer_options.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <optional>
#include <string>

#include "server/conversation/control_json.h"
#include "server/http/number.h"

namespace kerf {
namespace {

/// Bytes per second, or nullopt if `kb` is not a budget.
std::optional<std::uint32_t> budget_of(const std::string& kb) {
  const auto number = net::parse_number<double>(kb);
  const double bytes = number ? *number * 1e3 : -1;
  const bool is_budget = bytes == 0 || (bytes >= net::kBudgetMin && bytes <= net::kBudgetMax);
  if (!is_budget) return std::nullopt;
  return static_cast<std::uint32_t>(std::llround(bytes));
}

}  // namespace

void describe_viewers(CLI::App& app, net::ServerOptions& server) {
  const auto check = [](const std::string& kb) {
    return budget_of(kb)
               ? std::string()
               : kb + " is not 0 or a number from " + std::to_string(net::kBudgetMin / 1000) +
                     " to " + std::to_string(net::kBudgetMax / 1000);
  };
  app.add_option_function<std::string>(
         "--viewer-budget",
         [&server](const std::string& kb) { server.viewer_budget = *budget_of(kb); },
         "kB per second of the surface that each viewer is sent at most: it gets coarser tiles "
         "while more changes; default: 0, no limit")
      ->type_name("FLOAT")
      ->check(CLI::Validator(check, ""));
}

}  // namespace kerf
