// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "haptic_agent/device/device_choice.h"
#include "haptic_agent/device/usb/usb_survey.h"
#include "haptic_agent/doctor/finding.h"
#include "haptic_agent/link/server_url.h"
#include "haptic_agent/realtime/realtime_thread.h"
#include "haptic_agent/servo/servo_loop.h"

namespace kerf::agent {

/// Requests the servo thread's privileges on a temporary thread, and releases them again.
RealtimeReport probe_realtime();

/// Returns a finding with the limits of this process and the configuration lines that raise them.
Finding judge_priority(const RealtimeReport& report);
Finding judge_memory_lock(const RealtimeReport& report);

/// Returns one finding per device; one if there is no device or USB cannot be used.
std::vector<Finding> judge_usb(const std::expected<std::vector<FoundDevice>, std::string>& survey);

/// Returns the udev rule that gives the local user access to such devices.
std::string udev_rule(UsbId id);

/// Waits up to `wait_s` until the device is ready. Then measures the latency of a device with
/// motors.
std::vector<Finding> check_device(const DeviceChoice& choice, double wait_s);

/// Waits like check_device, and identifies the device (Identification): writes its profile to
/// `path` and returns the findings. Passes the warning to `warn` before it moves the device.
std::vector<Finding> identify_device(const DeviceChoice& choice, double wait_s,
                                     const std::string& path,
                                     const std::function<void(const std::string&)>& warn);

/// Judges the measured latency of a device with motors against the declared one.
Finding judge_latency(const DeviceCapabilities& device, const CommandEcho& echo);

/// Returns a note if the device is so light for its latency that cuts feel softer than computed in
/// a loose grip, at the default pivot of scenes.
std::optional<Finding> judge_grip(const DeviceCapabilities& device);

/// Statistics of the servo loop and its scheduling.
struct LoopMeasurement {
  RealtimeReport realtime{};
  CycleStats stats{};
  /// Number of threads that kept all cores busy during the measurement. May be 0.
  unsigned load_threads = 0;
};
/// Targets for a loop with real-time priority: p99 wake-up latency and share of lost ticks.
inline constexpr std::uint64_t kFineWakeUs = 250;
inline constexpr double kFineLostShare = 0.005;

LoopMeasurement measure_loop(double seconds, bool load);
Finding judge_loop(const LoopMeasurement& measurement);

/// Connects several times, measures the round trip, and requests /healthz once.
Finding check_server(const ServerUrl& server, const std::string& authorities = {});

}  // namespace kerf::agent
