// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/usb/usb_haptic_device.h"

#include <utility>

namespace kerf::agent {

UsbHapticDevice::UsbHapticDevice(std::unique_ptr<HapticProtocol> protocol, UsbPortSettings settings)
    : protocol_(std::move(protocol)), port_(*protocol_, std::move(settings)) {
  port_.start();
}

DeviceState UsbHapticDevice::read(std::uint64_t now_us) noexcept {
  DeviceState state = protocol_->mailbox().fetch(now_us);
  state.phase = port_.phase();
  state.valid = state.valid && state.phase == DevicePhase::kReady;
  return state;
}

void UsbHapticDevice::write(const Wrench& wrench) noexcept {
  const bool ready = port_.phase() == DevicePhase::kReady;
  protocol_->mailbox().write(ready ? wrench : Wrench{});
  // Wakes the port only while it streams. Earlier, the wake-up would end its pause before the next
  // attempt to connect.
  if (ready) port_.wake();
}

void UsbHapticDevice::stop() noexcept {
  protocol_->mailbox().stop();
  port_.wake();
}

}  // namespace kerf::agent
