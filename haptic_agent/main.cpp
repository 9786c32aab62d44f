// SPDX-License-Identifier: Apache-2.0
#include <iostream>
#include <string_view>

#include "haptic_agent/doctor/doctor.h"
#include "haptic_agent/options.h"
#include "haptic_agent/realtime/realtime_thread.h"
#include "haptic_agent/recording_commands.h"
#include "haptic_agent/run_agents.h"

int main(int argc, char** argv) {
  // A failure only means that more memory is locked.
  kerf::agent::limit_thread_stacks();
  const std::string_view command = argc > 1 ? argv[1] : "";
  if (command == "doctor") return kerf::agent::run_doctor(argc - 1, argv + 1, std::cout);
  if (command == "feel") return kerf::agent::run_feel(argc - 1, argv + 1, std::cout);
  if (command == "export") return kerf::agent::run_export(argc - 1, argv + 1, std::cout);
  auto options = kerf::agent::read_options(argc, argv);
  if (!options) return options.error().code;
  return kerf::agent::run_agents(*std::move(options));
}
