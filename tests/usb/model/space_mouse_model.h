// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>

#include "tests/usb/model/usb_model.h"

namespace kerf::usb_test {

/// A SpaceMouse: while its cap is deflected it reports every 8 ms (push and turn alternating) or
/// every 16 ms (both in one report), then sends three pairs of zeros, then nothing.
class SpaceMouseModel final : public UsbModel {
 public:
  explicit SpaceMouseModel(bool combined = false) : combined_(combined) {}

  UsbShape shape() const override;
  std::optional<Bytes> control(const Setup& setup, std::span<const std::uint8_t> data) override;
  std::optional<Bytes> poll_in(std::uint64_t now_us) override;
  void take_out(std::span<const std::uint8_t>, std::uint64_t) override {}
  void power_cycle() override { counts_ = {}; }

  /// Sets the deflection in counts of -350 … 350 on the device's axes: three of push, three of
  /// turn.
  void push(const std::array<std::int16_t, 6>& counts);
  void press(std::uint8_t buttons);
  /// Sends nothing from now on, not even zeros, like a lost wireless receiver.
  void fall_silent() { left_ = 0; }

 private:
  bool combined_;
  std::array<std::int16_t, 6> counts_{};
  std::deque<Bytes> waiting_;
  /// Pairs still to be sent; unlimited while the cap is deflected.
  int left_ = 0;
  bool turn_next_ = false;
  std::uint64_t next_us_ = 0;
};

}  // namespace kerf::usb_test
