// SPDX-License-Identifier: Apache-2.0
// The part of Session that sets and removes pins.
#include <utility>

#include "server/rights/rights.h"
#include "server/session/pause_text.h"
#include "server/session/session.h"

namespace kerf {

bool Session::may_remove(const Pin& pin, const Caller& caller) {
  return kerf::may_change(caller, pin.person, Action::kPlacePins);
}

std::expected<Pin, PinError> Session::set_pin(Pin pin) {
  using enum PinFault;
  if (const auto error = journal_.pause()) {
    return std::unexpected(PinError{kPaused, pause_text(*error)});
  }
  if (closed_) return std::unexpected(PinError{kPaused, "the session is closed"});
  if (pins_.size() >= kPinsMax) {
    return std::unexpected(PinError{
        kLimit, "a session has at most " + std::to_string(kPinsMax) + " pins; remove some"});
  }
  pin.number = ++last_pin_;
  pin.record = sequence();
  journal_.append(PinChange{pin, false});
  pins_.emplace(pin.number, pin);
  ++pin_changes_;
  return pin;
}

std::expected<void, PinError> Session::remove_pin(std::uint32_t number, const Caller& caller) {
  using enum PinFault;
  const auto found = pins_.find(number);
  if (found == pins_.end()) {
    return std::unexpected(
        PinError{kUnknown, "there is no pin " + std::to_string(number) + "; it may be removed"});
  }
  if (!may_remove(found->second, caller)) {
    return std::unexpected(PinError{kNotAllowed, "the pin is another's: an owner may remove it"});
  }
  journal_.append(PinChange{found->second, true});
  pins_.erase(found);
  ++pin_changes_;
  return {};
}

std::vector<Pin> Session::pins() const {
  std::vector<Pin> list;
  list.reserve(pins_.size());
  for (const auto& [number, pin] : pins_) list.push_back(pin);
  return list;
}

std::optional<std::vector<Pin>> Session::pin_update(bool all) {
  const bool is_new = std::exchange(pin_changes_sent_, pin_changes_) != pin_changes_;
  if (!is_new && (!all || pins_.empty())) return std::nullopt;
  return pins();
}

}  // namespace kerf
