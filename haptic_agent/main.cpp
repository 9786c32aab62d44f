#include "haptic_agent/options.h"
#include "haptic_agent/run_agent.h"

int main(int argc, char** argv) {
  auto options = kerf::agent::read_options(argc, argv);
  if (!options) return options.error().code;
  return kerf::agent::run_agent(*std::move(options));
}
