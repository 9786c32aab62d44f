// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "haptic_agent/device/usb/device_mailbox.h"
#include "haptic_agent/device/usb/usb_port.h"

namespace kerf::agent {

/// Protocol of a haptic device: converts reports to poses and wrenches to reports, exchanged with
/// the servo through a mailbox.
class HapticProtocol : public UsbProtocol {
 public:
  DeviceMailbox& mailbox() noexcept { return mailbox_; }
  virtual DeviceCapabilities capabilities() const = 0;
  /// See HapticDevice::command_echo. Callable from any thread.
  virtual CommandEcho command_echo() const noexcept { return {}; }

 protected:
  DeviceMailbox mailbox_;
};

/// A HapticDevice connected by USB. The constructor starts the search for the device. The
/// destructor sets the motors to zero and closes it.
class UsbHapticDevice final : public HapticDevice {
 public:
  UsbHapticDevice(std::unique_ptr<HapticProtocol> protocol, UsbPortSettings settings);

  DeviceCapabilities capabilities() const override { return protocol_->capabilities(); }
  DeviceState read(std::uint64_t now_us) noexcept override;
  void write(const Wrench& wrench) noexcept override;
  void stop() noexcept override;
  std::string trouble() const override { return port_.trouble(); }
  CommandEcho command_echo() const noexcept override { return protocol_->command_echo(); }

  const UsbCounters& counters() const noexcept { return port_.counters(); }

 private:
  std::unique_ptr<HapticProtocol> protocol_;
  UsbPort port_;
};

}  // namespace kerf::agent
