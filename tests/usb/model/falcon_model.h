// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>

#include "haptic_agent/device/falcon/falcon_frame.h"
#include "kernel/math/vec3.h"
#include "tests/usb/model/usb_model.h"

namespace kerf::usb_test {

/// A Novint Falcon with its serial chip: a loader that must be woken, echoes the firmware and loses
/// it with its power, and a firmware that answers each command with one frame.
class FalconModel final : public UsbModel {
 public:
  struct Settings {
    bool has_firmware = true;
    std::size_t firmware_bytes = 300;
    /// Number of ignored wake requests, and of loads with a corrupted echo.
    int ignored_wake_requests = 0;
    int garbled_loads = 0;
    /// Number of answers until the legs are homed by the user.
    int homing_answers = 20;
  };

  FalconModel() : FalconModel(Settings{}) {}
  explicit FalconModel(const Settings& settings);

  UsbShape shape() const override;
  std::optional<Bytes> control(const Setup& setup, std::span<const std::uint8_t> data) override;
  std::optional<Bytes> poll_in(std::uint64_t now_us) override;
  void take_out(std::span<const std::uint8_t> packet, std::uint64_t now_us) override;
  void power_cycle() override;

  /// Moves the grip, in the Falcon's coordinates. The position must be within reach.
  void hold(Vec3 position_mm);
  void press(std::uint8_t buttons) { state_.buttons = buttons; }
  /// Splits answers into two packets, as happens at the end of a serial buffer.
  void split_answers(bool split) { split_ = split; }
  /// The firmware hangs. The serial chip continues.
  void hang(bool hung) { hung_ = hung; }

  std::array<std::int16_t, 3> motors() const { return motors_; }
  std::uint8_t lights() const { return lights_; }
  bool runs() const { return mode_ == Mode::kRun; }
  bool homed() const { return state_.homed == agent::falcon::kAllHomed; }
  int loads() const { return loads_; }
  /// Number of commands received before the last one was answered and before its 10 ms timeout. The
  /// real firmware loses synchronization.
  int impatient_commands() const { return impatient_; }

 private:
  enum class Mode { kAsleep, kAwake, kLoading, kRun };

  void transmit(std::span<const std::uint8_t> bytes);
  void load(std::span<const std::uint8_t> chunk);
  void obey(std::span<const std::uint8_t> packet, std::uint64_t now_us);

  Settings settings_;
  Mode mode_;
  agent::falcon::FalconState state_;
  std::array<std::int16_t, 3> motors_{};
  std::uint8_t lights_ = 0;
  std::uint16_t baud_ = 0;
  std::deque<Bytes> packets_;
  std::size_t loaded_bytes_ = 0;
  std::uint64_t next_status_us_ = 0;
  int answers_ = 0;
  int loads_ = 0;
  int wake_requests_ = 0;
  int impatient_ = 0;
  std::uint64_t obeyed_us_ = 0;
  bool split_ = false;
  bool hung_ = false;
};

}  // namespace kerf::usb_test
