// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "haptic_agent/device/gamepad/gamepad_report.h"
#include "haptic_agent/device/gamepad/rumble.h"
#include "haptic_agent/device/spacemouse/space_mouse.h"
#include "haptic_agent/device/usb/device_mailbox.h"

namespace kerf::agent {

struct GamepadSettings {
  /// An event device such as /dev/input/event5. If empty, the first gamepad found.
  std::string node;
  StockBox stock{};
  /// The session's tools and the initial one.
  std::vector<std::uint32_t> tools;
  std::uint32_t tool = 0;
  /// Called on the device's thread with a line for the user: why the device is not ready, or that
  /// it is.
  std::function<void(const std::string&)> notice{};
  /// Opens a node for reading and writing without blocking. Returns -1 and sets errno on failure.
  /// If empty, the operating system's open.
  std::function<int(const std::string& node)> open{};
};

/// A gamepad: sticks and triggers command a velocity of the tool. It has no motors that resist
/// motion; rumble indicates force and torque. It is searched for until found, and again after a
/// loss.
class Gamepad final : public HapticDevice {
 public:
  explicit Gamepad(GamepadSettings settings);
  ~Gamepad() override;
  Gamepad(const Gamepad&) = delete;
  Gamepad& operator=(const Gamepad&) = delete;

  DeviceCapabilities capabilities() const override;
  DeviceState read(std::uint64_t now_us) noexcept override;
  void write(const Wrench& wrench) noexcept override { rumble_.write(wrench); }
  void stop() noexcept override { rumble_.stop(); }
  std::string trouble() const override;

 private:
  struct TimedPad {
    PadState pad{};
    bool ready = false;
  };

  void run();
  int find();
  int open_gamepad(const std::string& node, std::string& trouble);
  void serve(int fd);
  bool take_events(int fd);
  void upload(int fd);
  void play(int fd, const RumbleLevel& level) noexcept;
  void report(const std::string& trouble);

  GamepadSettings settings_;
  RateControl control_;
  TimedPad newest_;            ///< servo thread
  std::uint64_t last_us_ = 0;  ///< servo thread; 0 before the first read
  LatestValue<TimedPad> pads_;
  DeviceMailbox rumble_;
  // Device's thread.
  GamepadReport report_;
  RumbleClock clock_;
  std::int16_t effect_ = -1;  ///< the kernel's id of the uploaded effect; -1 if none
  mutable std::mutex mutex_;  ///< guards trouble_
  std::string trouble_;
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace kerf::agent
