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

/// The first four fields of a control transfer; its length is the data's.
struct ControlSetup {
  std::uint8_t type = 0;
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  std::uint16_t index = 0;
};

/// A device that has just been opened and does not stream yet: each call waits for its end. Only
/// the event thread uses it, before a servo can want anything.
class UsbTalk {
 public:
  virtual ~UsbTalk() = default;
  /// Bytes moved. The direction is bit 7 of `setup.type`.
  virtual std::expected<std::size_t, UsbFault> control(const ControlSetup& setup,
                                                       std::span<std::uint8_t> data) = 0;
  /// One packet from the IN endpoint.
  virtual std::expected<std::size_t, UsbFault> read(std::span<std::uint8_t> data,
                                                    unsigned timeout_ms) = 0;
  virtual std::expected<std::size_t, UsbFault> write(std::span<const std::uint8_t> data,
                                                     unsigned timeout_ms) = 0;
  virtual std::uint8_t interface_number() const noexcept = 0;
  /// The program ends: give up.
  virtual bool stopping() const noexcept = 0;
};

/// What one kind of device means by its bytes. UsbPort calls all of it, on its event thread.
class UsbProtocol {
 public:
  virtual ~UsbProtocol() = default;

  virtual std::string_view name() const noexcept = 0;
  virtual std::vector<UsbId> ids() const = 0;
  virtual PipeWish pipes() const = 0;
  /// A device that has sent nothing for so long has died; 0: silence is normal.
  virtual std::uint64_t silence_limit_us() const noexcept = 0;

  /// Checks that it is what it should be, sets it up, loads its firmware.
  virtual std::expected<void, UsbError> identify(UsbTalk& talk) = 0;
  /// From now on `take` and `compose` are called.
  virtual void connected(std::uint64_t now_us) noexcept = 0;
  /// One packet, as it came; false if it was not understood. Nothing in it is trusted.
  virtual bool take(std::span<const std::uint8_t> packet, std::uint64_t now_us) noexcept = 0;
  /// The next packet to send, into `packet`; its length, or 0: nothing now. Called whenever nothing
  /// is on its way out: after every packet that came in or went out and every `wake`, and at least
  /// every 5 ms.
  virtual std::size_t compose(std::span<std::uint8_t> packet, std::uint64_t now_us) noexcept = 0;
  /// What was composed last has arrived.
  virtual void sent(std::uint64_t) noexcept {}
  /// No motor may pull any more; what is composed from now on says so.
  virtual void silence() noexcept = 0;
  /// It is gone: what it has told means nothing any more.
  virtual void disconnected() noexcept = 0;
  /// kHoming or kReady (kIdentified: a fault of its own keeps it from either).
  virtual DevicePhase phase() const noexcept = 0;
  /// What keeps it from being ready while it is connected; static text, empty: nothing.
  virtual std::string_view trouble() const noexcept = 0;
};

}  // namespace kerf::agent
