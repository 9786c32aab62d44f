// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/usb/usb_hand.h"

#include <utility>

namespace kerf::agent {

UsbHand::UsbHand(std::unique_ptr<HandProtocol> protocol, UsbPortSettings settings)
    : protocol_(std::move(protocol)), port_(*protocol_, std::move(settings)) {
  port_.start();
}

DeviceState UsbHand::read(std::uint64_t now_us) noexcept {
  DeviceState state = protocol_->mailbox().fetch(now_us);
  state.phase = port_.phase();
  state.valid = state.valid && state.phase == DevicePhase::kReady;
  return state;
}

void UsbHand::write(const Wrench& wrench) noexcept {
  const bool ready = port_.phase() == DevicePhase::kReady;
  protocol_->mailbox().show(ready ? wrench : Wrench{});
  // Before it streams nobody would take the wake-up, and the port would only look for its device
  // too often.
  if (ready) port_.wake();
}

void UsbHand::stop() noexcept {
  protocol_->mailbox().stop();
  port_.wake();
}

}  // namespace kerf::agent
