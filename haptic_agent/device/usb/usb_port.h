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

/// Below the servo's priority: ticks must not wait for reports.
inline constexpr int kUsbPriority = 79;

struct UsbPortSettings {
  /// Opens a usbfs node and returns its file descriptor, which the port then owns, or -1 if there
  /// is no device. For systems that pass opened nodes (sandboxes, phones), and for tests. If empty,
  /// the port searches the bus for the device's ids.
  std::function<int()> node{};
  /// Called on the event thread with a line for the user: a problem, or that the device is ready.
  std::function<void(const std::string&)> notice{};
  /// The pause between attempts to connect doubles from the first to the longest; plugging in a
  /// device ends it.
  std::uint64_t first_pause_us = 100'000;
  std::uint64_t longest_pause_us = 2'000'000;
};

/// Keeps one device connected on its own event thread (SCHED_FIFO kUsbPriority if permitted): finds
/// it, opens it, has it identified by the protocol, exchanges reports, and reconnects after a loss.
class UsbPort {
 public:
  /// `protocol` must outlive the port.
  UsbPort(UsbProtocol& protocol, UsbPortSettings settings);
  /// Calls stop().
  ~UsbPort();
  UsbPort(const UsbPort&) = delete;
  UsbPort& operator=(const UsbPort&) = delete;

  /// Starts the thread. Call once.
  void start();
  /// Sets the motors to zero, closes the device and joins the thread.
  void stop();

  /// Wakes the event thread to send a packet. Callable from any thread; one system call, no lock.
  void wake() noexcept;
  DevicePhase phase() const noexcept { return phase_.load(std::memory_order_acquire); }
  /// See HapticDevice::trouble.
  std::string trouble() const;
  const UsbCounters& counters() const noexcept { return counters_; }

 private:
  class Worker;

  void set_phase(DevicePhase phase) noexcept { phase_.store(phase, std::memory_order_release); }
  /// Notifies the user if the text has changed.
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
