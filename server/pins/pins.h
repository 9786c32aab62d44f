// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/pins/pin.h"
#include "server/rights/caller.h"
#include "server/session/matter.h"

namespace kerf {

/// The pins of one session. Executor only, like all matters.
class Pins final : public Matter {
 public:
  explicit Pins(MatterBlock& block) : block_(block) {}
  static std::unique_ptr<Matter> make(MatterBlock& block) { return std::make_unique<Pins>(block); }

  /// Sets a pin. Its text must be plain (is_plain_text), its normal of unit length. Returns it with
  /// its number and record. Fails with `limit` at kPinsMax, and with `busy` while nothing can be
  /// recorded.
  std::expected<Pin, Error> set(Pin pin);
  /// Removes a pin. Fails with `unknown_pin` and `not_allowed`.
  std::expected<void, Error> remove(std::uint32_t number, const Caller& caller);
  /// Whether the caller may remove a pin: its own, or any as an owner.
  static bool may_remove(const Pin& pin, const Caller& caller);
  /// Returns the pins, by number.
  std::vector<Pin> list() const;

  std::string_view table() const override { return "pins"; }
  void restore(std::span<const ListRow> rows) override;
  std::optional<std::string> update(bool all) override;

 private:
  MatterBlock& block_;
  std::map<std::uint32_t, Pin> pins_;
  std::uint32_t last_ = 0;   ///< number of the newest pin since the server started
  bool is_changed_ = false;  ///< since the last update()
};

}  // namespace kerf
