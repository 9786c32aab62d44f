// SPDX-License-Identifier: Apache-2.0
#include <string_view>

#include "server/carve/carve.h"
#include "server/carve/carve_options.h"
#include "server/carve/tradeoff.h"

int main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "tradeoff") {
    const auto parsed = kerf::parse_tradeoff_options(argc - 1, argv + 1);
    if (const int* status = std::get_if<int>(&parsed)) return *status;
    return kerf::run_tradeoff(std::get<kerf::TradeoffOptions>(parsed));
  }
  const auto parsed = kerf::parse_carve_options(argc, argv);
  if (const int* status = std::get_if<int>(&parsed)) return *status;
  return kerf::run_carve(std::get<kerf::CarveOptions>(parsed));
}
