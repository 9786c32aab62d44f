// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/reference/reference_protocol.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "haptic_agent/device/text_fields.h"
#include "haptic_agent/device/units.h"
#include "server/wire/types.h"

namespace kerf::agent::reference {
namespace {

/// Accepted inconsistency of the encoders: play of the ball joints, and rounding.
constexpr double kMismatchMm = 2.0;
/// Largest plausible speed. A higher one means that an encoder slipped or wrapped.
constexpr double kMaxMmPerS = 5000.0;
constexpr double kJumpMm = 2.0;
/// After this time without a plausible pose, the next one is accepted.
constexpr std::uint64_t kForgetUs = 100'000;
/// Limit of plausible joint angles.
constexpr double kMaxAngleRad = 1.05 * std::numbers::pi;
/// Interval at which an unchanged command is repeated, for the firmware's watchdog.
constexpr std::uint64_t kKeepAliveUs = 4000;
constexpr std::uint64_t kSilenceUs = 500'000;
/// A report and a command of one 1 ms frame each, and the firmware's own loop.
constexpr std::uint64_t kLatencyUs = 3000;
/// Least mass and inertia of the pen and the ends of both arms (README.md).
constexpr double kMovingMassKg = 0.15;
constexpr double kMovingInertiaKgM2 = 2e-4;

bool within(double value, double least, double most) noexcept {
  return value >= least && value <= most;
}

bool is_buildable(const ArmShape& arm) noexcept {
  constexpr double kMaxMm = 2000.0;
  return length(arm.base_mm) < kMaxMm && within(arm.upper_mm, 20, 500) &&
         within(arm.fore_mm, 20, 500);
}

bool is_buildable(const PenShape& pen) noexcept {
  return is_buildable(pen.front) && is_buildable(pen.rear) && within(pen.length_mm, 20, 300) &&
         within(pen.grip_mm, 0, pen.length_mm);
}

/// Grip point of the pen when it is upright at the center of the workspace.
Vec3 middle_grip(const PenShape& pen) noexcept { return {0, 0, pen.grip_mm}; }

bool turns_too_far(const PenAngles& q) noexcept {
  const auto too_far = [](double angle) { return std::abs(angle) > kMaxAngleRad; };
  return std::ranges::any_of(q.front, too_far) || std::ranges::any_of(q.rear, too_far);
}

}  // namespace

DeviceCapabilities pen_capabilities(const PenPlace& place) {
  // When the pen tilts, the tip moves farther than the grip.
  const Vec3 reach_mm = kGripReachMm + Vec3{place.pivot_mm, place.pivot_mm, place.pivot_mm};
  return {.name = "5-DOF reference device",
          .sensed_dof = 5,
          .actuated_dof = 5,
          .max_force_n = 10.0,
          .max_torque_nmm = 250.0,
          .continuous_force_n = 3.0,
          .continuous_torque_nmm = 100.0,
          .max_stiffness_n_per_mm = 2.0,
          .max_damping_n_s_per_mm = 0.01,
          .latency_us = kLatencyUs,
          .moving_mass_kg = kMovingMassKg,
          .moving_inertia_kg_m2 = kMovingInertiaKgM2,
          .workspace_min_mm = place.middle_mm - reach_mm,
          .workspace_max_mm = place.middle_mm + reach_mm,
          .has_deadman = true};
}

ReferenceProtocol::ReferenceProtocol(const PenPlace& place, UsbId id) noexcept
    : place_(place), id_(id) {}

PipeRequirements ReferenceProtocol::required_pipes() const {
  return {.usb_class = kUsbClass,
          .usb_subclass = kUsbSubclass,
          .usb_protocol = kUsbProtocol,
          .kind = TransferKind::kInterrupt,
          .needs_out = true,
          .min_packet_bytes = kStateBytes};
}

std::uint64_t ReferenceProtocol::silence_limit_us() const noexcept { return kSilenceUs; }

std::expected<void, UsbError> ReferenceProtocol::identify(UsbSyncIo& io) {
  const auto wrong = [&](std::string_view reason) {
    return std::unexpected(usb_error(UsbFault::kWrongDevice, name(), reason));
  };
  std::array<std::uint8_t, kIdentityBytes> bytes{};
  const auto got = io.control(
      {.type = kIdentityRequestType, .request = kIdentityRequest, .index = io.interface_number()},
      bytes);
  if (!got && got.error() == UsbFault::kStall)
    return wrong("it does not support the identity request");
  if (!got) return std::unexpected(usb_error(got.error(), name()));
  const auto identity = decode_identity(std::span(bytes).first(*got));
  if (!identity) return wrong("its identity is invalid");
  if (identity->version != kVersion) {
    return wrong(
        join({"it uses version ", std::to_string(identity->version),
              " of the protocol, this program supports version ", std::to_string(kVersion)}));
  }
  if (!is_buildable(identity->pen)) return wrong("its dimensions are out of range");
  if (identity->watchdog_ms == 0 || identity->watchdog_ms > kWatchdogMs) {
    return wrong(join({"its watchdog timeout is ", std::to_string(identity->watchdog_ms),
                       " ms, it must be 1 to ", std::to_string(kWatchdogMs), " ms"}));
  }
  identity_ = *identity;
  return {};
}

void ReferenceProtocol::connected(std::uint64_t) noexcept {
  report_.reset();
  pose_.reset();
  joints_.reset();
  command_clock_.restart();
  mismatched_ = false;
  motors_disabled_ = false;
  sent_us_ = 0;
}

bool ReferenceProtocol::is_new(std::uint16_t sequence, std::uint64_t now_us) const noexcept {
  if (!report_) return true;
  const auto ahead = static_cast<std::int16_t>(sequence - report_->sequence);
  // A restarted firmware may count from any number. A hanging one repeats the same number.
  const bool forgotten = now_us - std::min(now_us, report_us_) > kForgetUs;
  return ahead > 0 || (forgotten && ahead != 0);
}

bool ReferenceProtocol::is_plausible(const PenPose& pose, std::uint64_t now_us,
                                     std::uint64_t gap_us) noexcept {
  mismatched_ = std::abs(pose.mismatch_mm) > kMismatchMm;
  if (mismatched_) return false;
  if (!pose_ || now_us - std::min(now_us, pose_us_) > kForgetUs) return true;
  // The limit uses the time between two reports, not the time since the last accepted pose: a
  // repeated jump must not be accepted.
  const double most_mm = kJumpMm + kMaxMmPerS * static_cast<double>(gap_us) / kUsPerS;
  const Vec3 tip = pose.grip_mm - pose.axis * place_.pivot_mm;
  const Vec3 last_tip = pose_->grip_mm - pose_->axis * place_.pivot_mm;
  return length(tip - last_tip) <= most_mm;
}

bool ReferenceProtocol::take(std::span<const std::uint8_t> packet, std::uint64_t now_us) noexcept {
  const auto report = decode_state(packet);
  if (!report || !is_new(report->sequence, now_us)) return false;
  const std::uint64_t gap_us = now_us - std::min(now_us, report_us_);
  report_ = *report;
  report_us_ = now_us;
  command_clock_.accepted(report->accepted, now_us);
  if (phase() == DevicePhase::kHoming) {
    // The angles are not valid yet, but the report is.
    pose_.reset();
    return true;
  }
  const PenAngles q = angles_of(*report);
  const auto measured = turns_too_far(q) ? std::nullopt : pen_pose(identity_.pen, q);
  if (!measured || !is_plausible(*measured, now_us, gap_us)) return false;
  if (gap_us > kForgetUs) joints_.reset();
  const auto estimated =
      pen_pose(identity_.pen, joints_.take(q, static_cast<double>(gap_us) / kUsPerS));
  pose_ = estimated ? estimated : measured;
  pose_us_ = now_us;
  const Vec3 grip_mm =
      place_.middle_mm + Vec3{0, 0, place_.pivot_mm} + pose_->grip_mm - middle_grip(identity_.pen);
  const bool cutting = (report->buttons & kCutButton) != 0;
  const bool held = (report->buttons & kGripSensor) != 0;
  const bool clutch = (report->buttons & kClutchButton) != 0;
  mailbox_.publish({.tip_mm = grip_mm - pose_->axis * place_.pivot_mm,
                    .axis = pose_->axis,
                    .buttons = (cutting ? wire::kButtonCutting : 0U) |
                               (held ? wire::kButtonDeadman : 0U) | (clutch ? kButtonClutch : 0U),
                    .time_us = now_us,
                    .valid = true,
                    .phase = phase()});
  return true;
}

CommandReport ReferenceProtocol::command(std::uint64_t now_us) noexcept {
  bool changed = false;
  const Wrench wrench = mailbox_.output(now_us, changed);
  const bool due =
      changed || motors_disabled_ || now_us - std::min(now_us, sent_us_) >= kKeepAliveUs;
  if (!due) return {};
  CommandReport report{.sequence = ++sequence_, .command = kEnableMotors};
  if (motors_disabled_) {
    report.command = 0;
    return report;
  }
  if (phase() == DevicePhase::kHoming) report.command = kStartHoming;
  if (phase() != DevicePhase::kReady || !pose_ || !report_) return report;
  const bool current = now_us - std::min(now_us, pose_us_) < DeviceMailbox::kPoseLifeUs;
  // After its watchdog has tripped, the firmware requires a command without torque.
  const bool tripped = (report_->status & kWatchdogBit) != 0;
  if (!current || tripped) return report;
  const PenAngles q = angles_of(*report_);
  const PointForces forces = distribute(identity_.pen, pose_->axis, wrench);
  report.torques_dnmm =
      wire_torques(pen_torques(identity_.pen, q, forces), identity_.torque_max_nmm);
  return report;
}

std::size_t ReferenceProtocol::compose(std::span<std::uint8_t> packet,
                                       std::uint64_t now_us) noexcept {
  const std::uint16_t before = sequence_;
  const CommandReport report = command(now_us);
  if (sequence_ == before || packet.size() < kCommandBytes) return 0;
  std::ranges::copy(encode(report), packet.begin());
  sent_us_ = now_us;
  command_clock_.composed(report.sequence, now_us);
  return kCommandBytes;
}

void ReferenceProtocol::disconnected() noexcept {
  report_.reset();
  pose_.reset();
  mailbox_.stop();
}

DevicePhase ReferenceProtocol::phase() const noexcept {
  if (!report_ || (report_->status & kHomedMask) != kHomedMask) return DevicePhase::kHoming;
  const std::uint16_t faults = kTooHotBit | kOverCurrentBit | kEmergencyStopBit;
  if ((report_->status & faults) != 0) return DevicePhase::kIdentified;
  return DevicePhase::kReady;
}

std::string_view ReferenceProtocol::trouble() const noexcept {
  const std::uint16_t status = report_ ? report_->status : std::uint16_t{0};
  if ((status & kEmergencyStopBit) != 0) return "the device's emergency stop is pressed";
  if ((status & kTooHotBit) != 0) return "the device's motors are too hot; let them cool down";
  if ((status & kOverCurrentBit) != 0) return "the device's motors drew too much current";
  if (phase() == DevicePhase::kHoming) return "the device is homing";
  if (mismatched_) return "the joint angles of the device's arms are inconsistent; home it again";
  return {};
}

}  // namespace kerf::agent::reference
