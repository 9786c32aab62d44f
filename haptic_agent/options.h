// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <optional>
#include <string>
#include <vector>

#include "haptic_agent/device/device_choice.h"
#include "haptic_agent/device/device_profile.h"
#include "haptic_agent/link/server_link.h"
#include "haptic_agent/mapping_options.h"
#include "haptic_agent/servo/servo_cycle.h"
#include "haptic_agent/study/trial_run.h"

namespace kerf::agent {

/// Options of the command line.
struct Options {
  LinkSettings link;
  DeviceChoice device;
  /// Further devices. Each joins as a separate participant.
  std::vector<DeviceChoice> more_devices;
  DeviceOptions device_options;
  WrenchLimits limits;
  ForceMode mode = ForceMode::kModel;
  /// Declared latency of the device, us; ignored if its driver declares a longer one.
  std::uint64_t latency_us = 0;
  /// The tool cuts whenever force is permitted, for a device without a button.
  bool always_cut = false;
  MappingOptions mapping;
  /// Measured values of the device. They replace those that its driver declares (with_profile).
  std::optional<DeviceProfile> profile;
  /// Factor of the session's guides, 0 to 1.
  double guide_strength = 1;
  /// In mode model: maintain a replica of the block near the tool and render its forces.
  bool keep_copy = true;
  double duration_s = 0;
  /// Processor to pin the loop to; negative for any.
  int cpu = -1;
  /// ALSA's device for the sound of spindle and cut. Empty for no sound.
  std::string sound;
  /// Show the agent's state on the terminal.
  bool view = false;
  /// File for the last 200 ms before a trip. If empty, standard error.
  std::string trip_log;
  /// MCAP file for every tick of the loop, which must not exist. Empty for no recording.
  std::string record_file;
  /// Table of a two-alternative test of the paper's loop and Kerf's, which must not exist. Empty
  /// for no test.
  std::string study_file;
  TrialSettings study{};
  /// File for the summary as JSON; "-" for standard output, empty for none.
  std::string status_json;
};

/// The program must exit without carving: it has printed the help (code 0), or an error in the
/// command line or in a file that it names (code 2).
struct EarlyExit {
  int code = 0;
};

/// Parses the command line and reads the device's file.
std::expected<Options, EarlyExit> read_options(int argc, const char* const* argv);

}  // namespace kerf::agent
