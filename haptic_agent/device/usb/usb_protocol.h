// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/device/usb/endpoints.h"
#include "haptic_agent/device/usb/usb_fault.h"

namespace kerf::agent {

struct UsbId {
  std::uint16_t vendor = 0;
  std::uint16_t product = 0;

  bool operator==(const UsbId&) const = default;
};

/// The first four fields of a control transfer. The length is that of the data.
struct ControlSetup {
  std::uint8_t type = 0;
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
};

/// Synchronous transfers with an opened device, for its identification before the asynchronous
/// transfers start. Used on the event thread only.
class UsbSyncIo {
 public:
  virtual ~UsbSyncIo() = default;
  /// Performs a control transfer and returns the number of bytes transferred. Bit 7 of `setup.type`
  /// is the direction.
  virtual std::expected<std::size_t, UsbFault> control(const ControlSetup& setup,
                                                       std::span<std::uint8_t> data) = 0;
  /// Reads one packet from the IN endpoint.
  virtual std::expected<std::size_t, UsbFault> read(std::span<std::uint8_t> data,
                                                    unsigned timeout_ms) = 0;
  virtual std::expected<std::size_t, UsbFault> write(std::span<const std::uint8_t> data,
                                                     unsigned timeout_ms) = 0;
  virtual std::uint8_t interface_number() const noexcept = 0;
  /// True if the program is exiting; long operations must end.
  virtual bool stopping() const noexcept = 0;
};

/// Protocol of one kind of device. UsbPort calls all functions on its event thread.
class UsbProtocol {
 public:
  virtual ~UsbProtocol() = default;

  virtual std::string_view name() const noexcept = 0;
  virtual std::vector<UsbId> ids() const = 0;
  virtual PipeRequirements required_pipes() const = 0;
  /// A device that sends nothing for this time counts as lost. 0 for no limit.
  virtual std::uint64_t silence_limit_us() const noexcept = 0;

  /// Verifies the device, configures it and loads its firmware.
  virtual std::expected<void, UsbError> identify(UsbSyncIo& io) = 0;
  /// Called before the first `take` and `compose`.
  virtual void connected(std::uint64_t now_us) noexcept = 0;
  /// Processes a received packet, which is untrusted data. Returns false if it is invalid.
  virtual bool take(std::span<const std::uint8_t> packet, std::uint64_t now_us) noexcept = 0;
  /// Writes the next packet to send into `packet` and returns its length; 0 to send nothing. Called
  /// while no OUT transfer is in flight: after every received or sent packet, after every
  /// UsbPort::wake, and at least every 5 ms.
  virtual std::size_t compose(std::span<std::uint8_t> packet, std::uint64_t now_us) noexcept = 0;
  /// The last composed packet was sent.
  virtual void sent(std::uint64_t) noexcept {}
  /// Makes all further packets disable the motors.
  virtual void disable_motors() noexcept = 0;
  /// The device is lost: its last reports are no longer valid.
  virtual void disconnected() noexcept = 0;
  /// Returns kHoming, kReady, or kIdentified for a fault of the device itself.
  virtual DevicePhase phase() const noexcept = 0;
  /// Returns why a connected device is not ready, as static text. Empty if it is ready.
  virtual std::string_view trouble() const noexcept = 0;
};

}  // namespace kerf::agent
