// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "haptic_agent/device/usb/hand_mailbox.h"
#include "haptic_agent/device/usb/usb_port.h"

namespace kerf::agent {

/// A device that a hand holds: its protocol turns reports into poses and wrenches into reports.
class HandProtocol : public UsbProtocol {
 public:
  HandMailbox& mailbox() noexcept { return mailbox_; }
  virtual DeviceCapabilities capabilities() const = 0;

 protected:
  HandMailbox mailbox_;
};

/// Such a device as the servo sees it. Made, it looks for its device by itself; destroyed, it takes
/// the motors to zero and lets go.
class UsbHand final : public HapticDevice {
 public:
  UsbHand(std::unique_ptr<HandProtocol> protocol, UsbPortSettings settings);

  DeviceCapabilities capabilities() const override { return protocol_->capabilities(); }
  DeviceState read(std::uint64_t now_us) noexcept override;
  void write(const Wrench& wrench) noexcept override;
  void stop() noexcept override;
  std::string trouble() const override { return port_.trouble(); }

  const UsbCounters& counters() const noexcept { return port_.counters(); }

 private:
  std::unique_ptr<HandProtocol> protocol_;
  UsbPort port_;
};

}  // namespace kerf::agent
