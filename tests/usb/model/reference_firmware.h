// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "haptic_agent/device/reference/report.h"
#include "tests/usb/model/usb_model.h"

namespace kerf::usb_test {

/// The firmware specified in haptic_agent/device/reference/README.md, as a state machine: homing,
/// watchdog, validation of commands. The test sets the pen's pose.
class ReferenceFirmware final : public UsbModel {
 public:
  struct Settings {
    agent::reference::Identity identity{};
    std::uint64_t homing_us = 20'000;
    std::uint8_t in_address = 0x81;
    std::uint8_t out_address = 0x02;
  };
  static Settings standard();

  explicit ReferenceFirmware(const Settings& settings = standard());

  UsbShape shape() const override;
  std::optional<Bytes> control(const Setup& setup, std::span<const std::uint8_t> data) override;
  std::optional<Bytes> poll_in(std::uint64_t now_us) override;
  void take_out(std::span<const std::uint8_t> packet, std::uint64_t now_us) override;
  void power_cycle() override;

  /// Moves the pen: its grip point in the device's coordinates, and its direction (unit).
  void hold(Vec3 grip_mm, Vec3 axis);
  void press(std::uint16_t buttons) { report_.buttons = buttons; }
  void fail(std::uint16_t status_bits) { faults_ = status_bits; }
  /// Hangs: sends no reports but stays plugged in.
  void hang(bool hangs) { hangs_ = hangs; }
  /// Modifies each report before the checksum is computed. May be empty.
  std::function<void(agent::reference::StateReport&)> tamper;

  /// Returns the current motor torques, N·mm, or zero unless all conditions for a force hold.
  std::array<double, 6> motors_nmm(std::uint64_t now_us);
  /// Returns the joint angles of the encoders.
  agent::PenAngles angles() const { return agent::reference::angles_of(report_); }
  bool homed() const { return (report_.status & agent::reference::kHomedMask) == kAllHomed; }
  bool watchdog_tripped() const { return tripped_; }
  std::uint64_t commands() const { return commands_; }
  std::uint64_t rejected() const { return rejected_; }
  /// Returns the largest number of commands lost between two accepted ones.
  std::uint64_t lost_commands() const { return lost_; }

 private:
  static constexpr std::uint16_t kAllHomed = agent::reference::kHomedMask;

  void go_on(std::uint64_t now_us);

  Settings settings_;
  agent::reference::StateReport report_;
  std::array<std::int16_t, 6> torques_dnmm_{};
  bool enabled_ = false;
  bool tripped_ = false;
  bool heard_ = false;
  bool hangs_ = false;
  std::uint16_t faults_ = 0;
  std::uint64_t heard_us_ = 0;
  std::uint64_t next_us_ = 0;
  std::uint64_t homing_since_us_ = 0;
  std::uint64_t commands_ = 0;
  std::uint64_t rejected_ = 0;
  std::uint64_t lost_ = 0;
};

/// Inverse kinematics of an arm, elbow up. The point must be within reach.
agent::ArmAngles reach_for(const agent::ArmShape& shape, Vec3 point_mm);

}  // namespace kerf::usb_test
