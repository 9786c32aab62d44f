// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "haptic_agent/device/carving_figure.h"
#include "haptic_agent/device/socket/line_stream.h"
#include "haptic_agent/device/usb/command_clock.h"
#include "haptic_agent/device/usb/device_mailbox.h"

namespace kerf::agent {

struct SocketDeviceSettings {
  SocketAddress address;
  StockBox stock{};
  double pivot_mm = 60;
  std::uint32_t participant = 0;
  /// Longest time for which `open` waits for the process.
  double wait_s = 5;
  /// Called on the device's thread with a line for the user: lost, connected again.
  std::function<void(const std::string&)> notice{};
};

/// A device that another process serves over a Unix or TCP socket (README.md). After a loss it is
/// searched for until it is back with the same capabilities.
class SocketDevice final : public HapticDevice {
 public:
  /// Connects and reads the device's capabilities. The error is one sentence.
  static std::expected<std::unique_ptr<SocketDevice>, std::string> open(
      SocketDeviceSettings settings);
  ~SocketDevice() override;
  SocketDevice(const SocketDevice&) = delete;
  SocketDevice& operator=(const SocketDevice&) = delete;

  DeviceCapabilities capabilities() const override { return capabilities_; }
  DeviceState read(std::uint64_t now_us) noexcept override;
  void write(const Wrench& wrench) noexcept override;
  void stop() noexcept override;
  std::string trouble() const override;
  CommandEcho command_echo() const noexcept override { return clock_.echo(); }

 private:
  explicit SocketDevice(SocketDeviceSettings settings);
  std::expected<void, std::string> connect();
  void run();
  void serve();
  bool take_lines();
  bool send_wrench(std::uint64_t now_us);
  bool takes_wrenches(std::uint64_t asked_us) const noexcept;
  void lose(const std::string& reason);
  void report(const std::string& trouble);
  void wake() noexcept;

  SocketDeviceSettings settings_;
  /// Assigned at the first connection, before the device's thread starts; constant afterwards.
  DeviceCapabilities capabilities_;
  /// The device's first line. It must be the same after a loss.
  std::string device_line_;
  LineStream stream_;
  DeviceMailbox mailbox_;
  CommandClock clock_;
  DeviceState newest_;
  std::uint16_t number_ = 0;
  std::uint64_t sent_us_ = 0;    ///< when the newest wrench was queued; 0 if none is
  std::uint64_t queued_us_ = 0;  ///< when the newest line was queued
  int wake_fd_;
  mutable std::mutex mutex_;  ///< guards trouble_
  std::string trouble_;
  /// The device has sent kRearmLine, and the servo has not read it yet.
  std::atomic<bool> rearm_{false};
  std::atomic<bool> ending_{false};
  std::thread thread_;
};

}  // namespace kerf::agent
