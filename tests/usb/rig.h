// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/device/usb/usb_port.h"
#include "haptic_agent/realtime/clock.h"
#include "tests/usb/usbfs_calls.h"

namespace kerf::usb_test {

/// Polls a condition every millisecond. Returns false after ten seconds, a limit for failing tests
/// only.
template <typename Condition>
bool eventually(Condition condition) {
  for (int i = 0; i < 10'000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

/// The notices of a device, in order.
class Notices {
 public:
  void add(const std::string& line) {
    const std::lock_guard lock(mutex_);
    lines_.push_back(line);
  }
  bool has(const std::string& part) const { return count(part) > 0; }
  std::ptrdiff_t count(const std::string& part) const {
    const std::lock_guard lock(mutex_);
    return std::ranges::count_if(
        lines_, [&](const std::string& line) { return line.find(part) != std::string::npos; });
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> lines_;
};

/// A model on the in-process usbfs, and port settings that open it.
template <typename Model>
class Rig {
 public:
  template <typename... Arguments>
  explicit Rig(Arguments&&... arguments) : model(std::forward<Arguments>(arguments)...) {}

  agent::UsbPortSettings settings() {
    return {.node = [this] { return open_stub_node(bus); },
            .notice = [this](const std::string& line) { notices.add(line); },
            .first_pause_us = 5000,
            .longest_pause_us = 20'000};
  }
  /// Runs a query while the model does not change.
  template <typename Query>
  auto query(Query inspect) {
    return bus.with_model([&] { return inspect(model); });
  }

  Model model;
  UsbfsStub bus{model};
  Notices notices;
};

inline bool is_ready(agent::HapticDevice& device) {
  return device.read(agent::monotonic_us()).phase == agent::DevicePhase::kReady;
}

}  // namespace kerf::usb_test
