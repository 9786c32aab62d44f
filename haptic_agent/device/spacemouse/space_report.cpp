// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/spacemouse/space_report.h"

#include <algorithm>
#include <cmath>

namespace kerf::agent {
namespace {

constexpr std::uint8_t kPushReport = 1;
constexpr std::uint8_t kTurnReport = 2;
constexpr std::size_t kTripleBytes = 6;
/// Full deflection of every axis.
constexpr double kFullCounts = 350.0;

double axis_of(std::span<const std::uint8_t> bytes, std::size_t i) noexcept {
  const auto counts = static_cast<std::int16_t>(bytes[2 * i] | (bytes[2 * i + 1] << 8));
  return std::clamp(counts / kFullCounts, -1.0, 1.0);
}

/// Converts from the device's axes: x right, y towards the user, z down.
Vec3 triple_of(std::span<const std::uint8_t> bytes) noexcept {
  return {axis_of(bytes, 0), -axis_of(bytes, 1), -axis_of(bytes, 2)};
}

std::uint32_t buttons_of(std::span<const std::uint8_t> bytes) noexcept {
  std::uint32_t buttons = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(bytes.size(), 4); ++i) {
    buttons |= std::uint32_t{bytes[i]} << (8 * i);
  }
  return buttons;
}

}  // namespace

std::vector<UsbId> space_mouse_ids() {
  std::vector<UsbId> ids;
  for (const int product : {0xc603, 0xc605, 0xc606, 0xc621, 0xc623, 0xc625, 0xc626, 0xc627, 0xc628,
                            0xc629, 0xc62b, 0xc640}) {
    ids.push_back({0x046d, static_cast<std::uint16_t>(product)});
  }
  for (const int product :
       {0xc62e, 0xc62f, 0xc631, 0xc632, 0xc633, 0xc635, 0xc636, 0xc638, 0xc63a}) {
    ids.push_back({0x256f, static_cast<std::uint16_t>(product)});
  }
  return ids;
}

bool take_space_report(std::span<const std::uint8_t> report, CapDeflection& cap) noexcept {
  if (report.size() < 2) return false;
  const auto body = report.subspan(1);
  if (report[0] == kButtonReport) {
    cap.buttons = buttons_of(body);
    return true;
  }
  if (body.size() < kTripleBytes) return false;
  if (report[0] == kTurnReport) {
    cap.turn = triple_of(body);
    return true;
  }
  if (report[0] != kPushReport) return false;
  cap.push = triple_of(body);
  if (body.size() >= 2 * kTripleBytes) cap.turn = triple_of(body.subspan(kTripleBytes));
  return true;
}

double without_dead_zone(double value) noexcept {
  const double beyond = std::abs(value) - kDeadZone;
  if (!(beyond > 0)) return 0;
  return std::copysign(beyond / (1 - kDeadZone), value);
}

}  // namespace kerf::agent
