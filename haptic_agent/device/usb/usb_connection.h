// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <expected>
#include <vector>

#include "haptic_agent/device/usb/usb_counters.h"
#include "haptic_agent/device/usb/usb_protocol.h"

struct libusb_context;
struct libusb_device_handle;
struct libusb_transfer;

namespace kerf::agent {

/// An opened device: claims its interface and keeps kInFlight IN transfers and at most one OUT
/// transfer submitted. Used on the event thread only, which also runs libusb's callbacks.
class UsbConnection final : public UsbSyncIo {
 public:
  /// Takes ownership of `handle`. Setting `stopping` aborts an identification.
  UsbConnection(libusb_context* context, libusb_device_handle* handle, UsbProtocol& protocol,
                UsbCounters& counters, const std::atomic<bool>& stopping) noexcept;
  ~UsbConnection() override;
  UsbConnection(const UsbConnection&) = delete;
  UsbConnection& operator=(const UsbConnection&) = delete;

  /// Finds the endpoints that the protocol needs and claims their interface.
  std::expected<void, UsbError> claim();
  /// Starts the transfers. Call once, after the protocol has identified the device.
  std::expected<void, UsbError> start(std::uint64_t now_us);
  /// Clears endpoint halts and sends the next packet. Returns false if the device is lost. The
  /// connection must then be destroyed.
  bool pump(std::uint64_t now_us);
  /// Sends a final packet with the motors disabled, and waits for at most 20 ms until it is sent.
  void disable_motors();

  std::expected<std::size_t, UsbFault> control(const ControlSetup& setup,
                                               std::span<std::uint8_t> data) override;
  std::expected<std::size_t, UsbFault> read(std::span<std::uint8_t> data,
                                            unsigned timeout_ms) override;
  std::expected<std::size_t, UsbFault> write(std::span<const std::uint8_t> data,
                                             unsigned timeout_ms) override;
  std::uint8_t interface_number() const noexcept override { return pipes_.interface_number; }
  bool stopping() const noexcept override { return stopping_.load(); }

 private:
  /// A transfer and its buffer, allocated once and submitted repeatedly.
  struct Slot {
    UsbConnection* owner = nullptr;
    libusb_transfer* transfer = nullptr;
    std::vector<std::uint8_t> buffer{};
    bool in_flight = false;
  };
  static constexpr std::size_t kInFlight = 3;

  std::expected<std::size_t, UsbFault> transfer(std::uint8_t endpoint, std::uint8_t* data,
                                                std::size_t bytes, unsigned timeout_ms);
  static void in_done(libusb_transfer* transfer);
  static void out_done(libusb_transfer* transfer);
  bool prepare(Slot& slot, std::uint16_t bytes);
  void submit(Slot& slot) noexcept;
  void send(std::uint64_t now_us);
  void take_packet(const libusb_transfer& transfer) noexcept;
  void count_failure(int status, std::uint8_t endpoint) noexcept;
  void cancel_all() noexcept;

  libusb_context* context_;
  libusb_device_handle* handle_;
  UsbProtocol& protocol_;
  UsbCounters& counters_;
  const std::atomic<bool>& stopping_;
  Pipes pipes_;
  bool claimed_ = false;
  bool streaming_ = false;
  bool lost_ = false;
  /// Endpoint whose halt must be cleared outside the callbacks, or 0 if none.
  std::uint8_t halted_in_ = 0;
  std::uint8_t halted_out_ = 0;
  /// Failed transfers since the last good packet.
  int failures_ = 0;
  std::uint64_t last_packet_us_ = 0;
  std::array<Slot, kInFlight> ins_;
  Slot out_;
};

}  // namespace kerf::agent
