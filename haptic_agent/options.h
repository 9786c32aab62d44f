#pragma once

#include <expected>
#include <string>
#include <vector>

#include "haptic_agent/device/device_choice.h"
#include "haptic_agent/link/server_link.h"
#include "haptic_agent/servo/wrench_limiter.h"

namespace kerf::agent {

/// What the command line asks for.
struct Options {
  LinkSettings link;
  DeviceChoice device;
  /// Further devices, each of which joins as a participant of its own.
  std::vector<DeviceChoice> more_devices;
  DeviceOptions device_options;
  WrenchLimits limits;
  double duration_s = 0;
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
