// SPDX-License-Identifier: Apache-2.0
#include "tests/usb/model/reference_firmware.h"

#include <algorithm>
#include <cmath>

namespace kerf::usb_test {

namespace ref = agent::reference;

namespace {

constexpr double kUradPerRad = 1e6;
constexpr double kStepsPerNmm = 10.0;
constexpr std::uint64_t kUsPerMs = 1000;

std::int32_t to_urad(double rad) {
  return static_cast<std::int32_t>(std::lround(rad * kUradPerRad));
}

}  // namespace

agent::ArmAngles reach_for(const agent::ArmShape& shape, Vec3 point_mm) {
  const Vec3 to = point_mm - shape.base_mm;
  const double level = std::hypot(to.x, to.y);
  const double distance = std::hypot(level, to.z);
  const double cosine =
      (shape.upper_mm * shape.upper_mm + distance * distance - shape.fore_mm * shape.fore_mm) /
      (2 * shape.upper_mm * distance);
  const double upper = std::atan2(to.z, level) + std::acos(std::clamp(cosine, -1.0, 1.0));
  const double fore =
      std::atan2(to.z - shape.upper_mm * std::sin(upper), level - shape.upper_mm * std::cos(upper));
  return {std::atan2(to.y, to.x), upper, fore};
}

ReferenceFirmware::Settings ReferenceFirmware::standard() {
  return {.identity = {.firmware = 1,
                       .serial = 7,
                       .pen = agent::standard_pen(),
                       .torque_max_nmm = {1500, 1500, 1500, 1500, 1500, 1500},
                       .period_us = 1000,
                       .watchdog_ms = 20}};
}

ReferenceFirmware::ReferenceFirmware(const Settings& settings) : settings_(settings) {
  hold({0, 0, settings_.identity.pen.grip_mm}, {0, 0, 1});
}

UsbShape ReferenceFirmware::shape() const {
  return {.vendor = ref::kVendorId,
          .product = ref::kProductId,
          .usb_class = ref::kUsbClass,
          .usb_subclass = ref::kUsbSubclass,
          .usb_protocol = ref::kUsbProtocol,
          .kind = 3,
          .in_address = settings_.in_address,
          .out_address = settings_.out_address};
}

std::optional<Bytes> ReferenceFirmware::control(const Setup& setup, std::span<const std::uint8_t>) {
  if (setup.type != ref::kIdentityRequestType || setup.request != ref::kIdentityRequest) {
    return std::nullopt;
  }
  const auto bytes = ref::encode(settings_.identity);
  const std::size_t length = std::min<std::size_t>(bytes.size(), setup.length);
  return Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
}

void ReferenceFirmware::hold(Vec3 grip_mm, Vec3 axis) {
  const agent::PenShape& pen = settings_.identity.pen;
  const auto front = reach_for(pen.front, grip_mm - axis * pen.grip_mm);
  const auto rear = reach_for(pen.rear, grip_mm + axis * (pen.length_mm - pen.grip_mm));
  for (std::size_t i = 0; i < 3; ++i) {
    report_.angles_urad[i] = to_urad(front[i]);
    report_.angles_urad[i + 3] = to_urad(rear[i]);
  }
}

void ReferenceFirmware::go_on(std::uint64_t now_us) {
  if (homing_since_us_ != 0) {
    // Homes one joint after the other.
    const std::uint64_t share = std::max<std::uint64_t>(settings_.homing_us / 6, 1);
    const std::uint64_t found = std::min<std::uint64_t>((now_us - homing_since_us_) / share, 6);
    report_.status |= static_cast<std::uint16_t>((1U << found) - 1U);
    if (found == 6) homing_since_us_ = 0;
  }
  const std::uint64_t limit_us = settings_.identity.watchdog_ms * kUsPerMs;
  if (enabled_ && now_us - heard_us_ > limit_us) {
    tripped_ = true;
    enabled_ = false;
    torques_dnmm_ = {};
  }
}

std::optional<Bytes> ReferenceFirmware::poll_in(std::uint64_t now_us) {
  go_on(now_us);
  if (next_us_ == 0) next_us_ = now_us;
  if (hangs_ || now_us < next_us_) return std::nullopt;
  // A late host gets only the newest report.
  while (next_us_ <= now_us) next_us_ += settings_.identity.period_us;
  ++report_.sequence;
  report_.time_us = static_cast<std::uint32_t>(now_us);
  ref::StateReport sent = report_;
  sent.status |= faults_;
  if (homing_since_us_ != 0) sent.status |= ref::kHomingBit;
  if (enabled_) sent.status |= ref::kMotorsOnBit;
  if (tripped_) sent.status |= ref::kWatchdogBit;
  if (!homed()) sent.angles_urad = {};
  if (tamper) tamper(sent);
  const auto bytes = ref::encode(sent);
  return Bytes(bytes.begin(), bytes.end());
}

void ReferenceFirmware::take_out(std::span<const std::uint8_t> packet, std::uint64_t now_us) {
  go_on(now_us);
  const auto command = ref::decode_command(packet);
  const auto ahead =
      command ? static_cast<std::int16_t>(command->sequence - report_.accepted) : std::int16_t{0};
  if (!command || (heard_ && ahead <= 0)) {
    ++rejected_;
    ++report_.rejected;
    return;
  }
  if (heard_) lost_ += static_cast<std::uint64_t>(ahead - 1);
  heard_ = true;
  heard_us_ = now_us;
  ++commands_;
  report_.accepted = command->sequence;
  const bool still = std::ranges::all_of(command->torques_dnmm, [](auto t) { return t == 0; });
  // After a trip, the first command must have no torque.
  if (tripped_ && !still) return;
  tripped_ = false;
  enabled_ = (command->command & ref::kEnableMotors) != 0 && homed();
  torques_dnmm_ = enabled_ ? command->torques_dnmm : std::array<std::int16_t, 6>{};
  if ((command->command & ref::kStartHoming) != 0 && !homed() && homing_since_us_ == 0) {
    homing_since_us_ = now_us;
  }
}

void ReferenceFirmware::power_cycle() {
  report_.status = 0;
  report_.sequence = 0;
  report_.accepted = 0;
  torques_dnmm_ = {};
  enabled_ = tripped_ = heard_ = false;
  next_us_ = homing_since_us_ = 0;
}

std::array<double, 6> ReferenceFirmware::motors_nmm(std::uint64_t now_us) {
  go_on(now_us);
  std::array<double, 6> torques{};
  if (faults_ != 0) return torques;
  for (std::size_t i = 0; i < torques.size(); ++i) torques[i] = torques_dnmm_[i] / kStepsPerNmm;
  return torques;
}

}  // namespace kerf::usb_test
