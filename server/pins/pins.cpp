// SPDX-License-Identifier: Apache-2.0
#include "server/pins/pins.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "server/rights/rights.h"

namespace kerf {

bool Pins::may_remove(const Pin& pin, const Caller& caller) {
  return may_change(caller, pin.person, Action::kPlacePins);
}

std::expected<Pin, Error> Pins::set(Pin pin) {
  if (auto obstacle = block_.obstacle()) return std::unexpected(*std::move(obstacle));
  if (pins_.size() >= kPinsMax) {
    return std::unexpected(
        Error{ErrorKind::kConflict, "limit",
              "a session has at most " + std::to_string(kPinsMax) + " pins; remove some"});
  }
  pin.number = ++last_;
  pin.record = block_.sequence();
  block_.record({.table = table(), .stored = to_row(pin)});
  pins_.emplace(pin.number, pin);
  is_changed_ = true;
  return pin;
}

std::expected<void, Error> Pins::remove(std::uint32_t number, const Caller& caller) {
  const auto found = pins_.find(number);
  if (found == pins_.end()) {
    return std::unexpected(
        Error{ErrorKind::kUnknown, "unknown_pin",
              "there is no pin " + std::to_string(number) + "; it may be removed"});
  }
  if (!may_remove(found->second, caller)) {
    return std::unexpected(Error{ErrorKind::kNotAllowed, "not_allowed",
                                 "the pin is another's: an owner may remove it"});
  }
  block_.record({.table = table(), .removed = std::int64_t{number}});
  pins_.erase(found);
  is_changed_ = true;
  return {};
}

std::vector<Pin> Pins::list() const {
  std::vector<Pin> list;
  list.reserve(pins_.size());
  for (const auto& [number, pin] : pins_) list.push_back(pin);
  return list;
}

void Pins::restore(std::span<const ListRow> rows) {
  is_changed_ = is_changed_ || !pins_.empty() || !rows.empty();
  pins_.clear();
  for (const ListRow& row : rows) {
    Pin pin = pin_of(row);
    last_ = std::max(last_, pin.number);
    pins_.emplace(pin.number, std::move(pin));
  }
}

std::optional<std::string> Pins::update(bool all) {
  const bool is_new = std::exchange(is_changed_, false);
  if (!is_new && (!all || pins_.empty())) return std::nullopt;
  nlohmann::json list = nlohmann::json::array();
  for (const auto& [number, pin] : pins_) list.push_back(nlohmann::json::parse(pin_json(pin)));
  const nlohmann::json message = {{"type", "pins"}, {"pins", std::move(list)}};
  return message.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace kerf
