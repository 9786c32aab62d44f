// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "haptic_agent/device/usb/usb_counters.h"
#include "haptic_agent/device/usb/usb_protocol.h"

namespace kerf::agent {

/// Below the servo: a report may wait for a tick, a tick never for a report.
inline constexpr int kUsbPriority = 79;

struct UsbPortSettings {
  /// Opens a usbfs node and gives its descriptor away, or -1: none there now. For systems that hand
  /// out opened nodes (sandboxes, phones), and for tests. Empty: the port looks for the device's
  /// ids on the bus.
  std::function<int()> node{};
  /// One line for the user, on the event thread: what is wrong, and when it is no longer.
  std::function<void(const std::string&)> notice{};
  /// The pause before looking again doubles from the first to the longest; a device that is plugged
  /// in ends it.
  std::uint64_t first_pause_us = 100'000;
  std::uint64_t longest_pause_us = 2'000'000;
};

/// Keeps one device connected, on a thread of its own (SCHED_FIFO kUsbPriority where allowed):
/// finds it, opens it, lets the protocol identify it, streams, and does it again after a loss.
class UsbPort {
 public:
  /// `protocol` must outlive the port.
  UsbPort(UsbProtocol& protocol, UsbPortSettings settings);
  /// As stop().
  ~UsbPort();
  UsbPort(const UsbPort&) = delete;
  UsbPort& operator=(const UsbPort&) = delete;

  /// Starts the thread. Call once.
  void start();
  /// Takes the motors to zero, closes the device, ends the thread.
  void stop();

  /// There is something new to compose. From any thread; one system call, no lock.
  void wake() noexcept;
  DevicePhase phase() const noexcept { return phase_.load(std::memory_order_acquire); }
  /// As HapticDevice::trouble.
  std::string trouble() const;
  const UsbCounters& counters() const noexcept { return counters_; }

 private:
  class Worker;

  void set_phase(DevicePhase phase) noexcept { phase_.store(phase, std::memory_order_release); }
  /// Tells the user, if it is not what was told last.
  void set_trouble(std::string_view text);

  UsbProtocol& protocol_;
  UsbPortSettings settings_;
  UsbCounters counters_;
  std::atomic<DevicePhase> phase_{DevicePhase::kClosed};
  std::atomic<bool> stopping_{false};
  int wake_fd_;
  mutable std::mutex trouble_mutex_;
  std::string trouble_;
  std::thread thread_;
};

}  // namespace kerf::agent
