// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <string>
#include <vector>

#include "haptic_agent/device/device_choice.h"
#include "haptic_agent/device/usb/usb_survey.h"
#include "haptic_agent/doctor/finding.h"
#include "haptic_agent/link/server_url.h"
#include "haptic_agent/servo/realtime.h"
#include "haptic_agent/servo/servo_loop.h"

namespace kerf::agent {

/// What the servo's thread asks for, asked for by a thread of its own, and given back.
RealtimeReport probe_realtime();

/// With the limits of this process and the lines that raise them.
Finding judge_priority(const RealtimeReport& report);
Finding judge_memory_lock(const RealtimeReport& report);

/// One finding a device; one if there is none or USB does not work.
std::vector<Finding> judge_usb(const std::expected<std::vector<FoundDevice>, std::string>& survey);

/// The line of a udev rules file that lets this machine's user open such devices.
std::string udev_rule(UsbId id);

/// Looks for the device until it is ready, at most `wait_s`.
Finding check_device(const DeviceChoice& choice, double wait_s);

/// The servo loop as it runs, with its scheduling.
struct LoopMeasurement {
  RealtimeReport realtime{};
  CycleStats stats{};
  /// Ordinary threads that kept every core busy meanwhile; 0: none.
  unsigned load_threads = 0;
};
/// What counts as fine for a loop with real-time priority.
inline constexpr std::uint64_t kFineWakeUs = 250;
inline constexpr double kFineLostShare = 0.005;

LoopMeasurement measure_loop(double seconds, bool load);
Finding judge_loop(const LoopMeasurement& measurement);

/// Connects several times and asks once whether the server is well.
Finding check_server(const ServerUrl& server);

}  // namespace kerf::agent
