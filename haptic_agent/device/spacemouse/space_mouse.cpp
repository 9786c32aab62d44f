// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/spacemouse/space_mouse.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "haptic_agent/device/units.h"
#include "server/wire/types.h"

namespace kerf::agent {
namespace {

constexpr std::uint8_t kHidClass = 3;
constexpr std::uint16_t kMinPacketBytes = 7;
constexpr double kClearMm = 10.0;
constexpr double kAroundMm = 50.0;
constexpr std::uint32_t kLeftButton = 1;
constexpr std::uint32_t kRightButton = 2;
/// Longest time integrated by one read, so that a pause of the loop does not make the tool jump.
constexpr double kLongestStepS = 0.01;

Vec3 shaped(Vec3 v) noexcept {
  return {without_dead_zone(v.x), without_dead_zone(v.y), without_dead_zone(v.z)};
}

Vec3 clamped(Vec3 v, Vec3 least, Vec3 most) noexcept {
  return {std::clamp(v.x, least.x, most.x), std::clamp(v.y, least.y, most.y),
          std::clamp(v.z, least.z, most.z)};
}

/// Limits the tilt of an axis to kMaxLeanRad.
Vec3 within_lean(Vec3 axis) noexcept {
  const double least_z = std::cos(RateControl::kMaxLeanRad);
  if (axis.z >= least_z) return axis;
  const double level = std::hypot(axis.x, axis.y);
  const double sine = std::sin(RateControl::kMaxLeanRad);
  return {axis.x / level * sine, axis.y / level * sine, least_z};
}

}  // namespace

RateControl::RateControl(const StockBox& stock) noexcept
    : least_mm_(stock.min_mm - Vec3{kAroundMm, kAroundMm, kAroundMm}),
      most_mm_(stock.max_mm + Vec3{kAroundMm, kAroundMm, kAroundMm}),
      tip_mm_{(stock.min_mm.x + stock.max_mm.x) / 2, (stock.min_mm.y + stock.max_mm.y) / 2,
              stock.max_mm.z + kClearMm} {}

void RateControl::step(const CapDeflection& cap, double dt_s) noexcept {
  const double share = (cap.buttons & kRightButton) != 0 ? kPrecise : 1.0;
  const Vec3 travel_mm = shaped(cap.push) * (kFullMmPerS * share * dt_s);
  tip_mm_ = clamped(tip_mm_ + travel_mm, least_mm_, most_mm_);
  const Vec3 turn_rad = shaped(cap.turn) * (kFullRadPerS * share * dt_s);
  axis_ = within_lean(normalized(axis_ + cross(turn_rad, axis_)));
}

PipeRequirements SpaceMouse::Protocol::required_pipes() const {
  return {.usb_class = kHidClass,
          .kind = TransferKind::kInterrupt,
          .needs_out = false,
          .min_packet_bytes = kMinPacketBytes};
}

bool SpaceMouse::Protocol::take(std::span<const std::uint8_t> packet,
                                std::uint64_t now_us) noexcept {
  if (!take_space_report(packet, cap_)) return false;
  // A button report contains no deflection and must not extend the validity of the last one.
  if (packet[0] != kButtonReport) moved_us_ = now_us;
  caps.write({.cap = cap_, .time_us = moved_us_});
  return true;
}

SpaceMouse::SpaceMouse(const StockBox& stock, UsbPortSettings settings)
    : control_(stock), port_(protocol_, std::move(settings)) {
  port_.start();
}

DeviceCapabilities SpaceMouse::capabilities() const {
  return {.name = "SpaceMouse",
          .sensed_dof = 5,
          .actuated_dof = 0,
          .workspace_min_mm = control_.least_mm(),
          .workspace_max_mm = control_.most_mm(),
          .has_deadman = false};
}

DeviceState SpaceMouse::read(std::uint64_t now_us) noexcept {
  protocol_.caps.read(newest_);
  const double passed_s =
      last_us_ ? std::min(static_cast<double>(now_us - *last_us_) * kSPerUs, kLongestStepS) : 0.0;
  last_us_ = now_us;
  const DevicePhase phase = port_.phase();
  const bool ready = phase == DevicePhase::kReady;
  CapDeflection cap = newest_.cap;
  if (now_us >= newest_.time_us + kSilenceUs) cap.push = cap.turn = {};
  if (ready) control_.step(cap, passed_s);
  // Buttons are reported only on changes, so they stay valid during silence, until the device is
  // lost.
  const bool cutting = ready && (cap.buttons & kLeftButton) != 0;
  return {.tip_mm = control_.tip_mm(),
          .axis = control_.axis(),
          .buttons = wire::kButtonDeadman | (cutting ? wire::kButtonCutting : 0U),
          .time_us = now_us,
          .valid = ready,
          .phase = phase};
}

}  // namespace kerf::agent
