// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <string>
#include <vector>

#include "haptic_agent/device/device_choice.h"
#include "haptic_agent/link/server_link.h"
#include "haptic_agent/servo/servo_cycle.h"

namespace kerf::agent {

/// What the command line asks for.
struct Options {
  LinkSettings link;
  DeviceChoice device;
  /// Further devices, each of which joins as a participant of its own.
  std::vector<DeviceChoice> more_devices;
  DeviceOptions device_options;
  WrenchLimits limits;
  ForceMode mode = ForceMode::kModel;
  /// In mode model: keep a copy of the block near the tool, and feel that.
  bool keep_copy = true;
  double duration_s = 0;
  /// The processor on which the loop stays; below 0: any.
  int cpu = -1;
  /// Draw the agent's state on the terminal.
  bool view = false;
  /// Where the last 200 ms before a trip go; empty: to standard error.
  std::string trip_log;
  /// Where the summary goes as JSON: a file, "-" for standard output, or nowhere.
  std::string status_json;
};

/// How the program ends if it is not to carve: what was printed is either help (exit code 0) or
/// what is wrong with the command line or a file that it names (exit code 2).
struct EarlyExit {
  int code = 0;
};

/// Reads the command line and the device's file.
std::expected<Options, EarlyExit> read_options(int argc, const char* const* argv);

}  // namespace kerf::agent
