// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/reference/reference_protocol.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "haptic_agent/device/text_fields.h"
#include "server/wire/types.h"

namespace kerf::agent::reference {
namespace {

/// The encoders may contradict each other by so much: play of the ball joints and rounding.
constexpr double kMismatchMm = 2.0;
/// No hand is faster than this; what is, is an encoder that slipped or wrapped.
constexpr double kMostMmPerS = 5000.0;
constexpr double kJumpMm = 2.0;
/// After so long without a plausible pose the next one is believed again.
constexpr std::uint64_t kForgetUs = 100'000;
/// Joints cannot turn farther than once around.
constexpr double kMostAngleRad = 1.05 * std::numbers::pi;
/// Without anything new to say a command still goes out this often: the firmware's watchdog waits
/// for it.
constexpr std::uint64_t kKeepAliveUs = 4000;
constexpr std::uint64_t kSilenceUs = 500'000;
constexpr double kUsPerS = 1e6;

bool within(double value, double least, double most) noexcept {
  return value >= least && value <= most;
}

bool is_buildable(const ArmShape& arm) noexcept {
  constexpr double kMostMm = 2000.0;
  return length(arm.base_mm) < kMostMm && within(arm.upper_mm, 20, 500) &&
         within(arm.fore_mm, 20, 500);
}

bool is_buildable(const PenShape& pen) noexcept {
  return is_buildable(pen.front) && is_buildable(pen.rear) && within(pen.length_mm, 20, 300) &&
         within(pen.grip_mm, 0, pen.length_mm);
}

/// Of the standard pen, upright in the middle of its workspace.
Vec3 middle_grip(const PenShape& pen) noexcept { return {0, 0, pen.grip_mm}; }

bool turns_too_far(const PenAngles& q) noexcept {
  const auto too_far = [](double angle) { return std::abs(angle) > kMostAngleRad; };
  return std::ranges::any_of(q.front, too_far) || std::ranges::any_of(q.rear, too_far);
}

}  // namespace

DeviceCapabilities pen_capabilities(const PenPlace& place) {
  // A pen that leans takes the tip farther than the grip.
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
          .workspace_min_mm = place.middle_mm - reach_mm,
          .workspace_max_mm = place.middle_mm + reach_mm,
          .has_deadman = true};
}

ReferenceProtocol::ReferenceProtocol(const PenPlace& place, UsbId id) noexcept
    : place_(place), id_(id) {}

PipeWish ReferenceProtocol::pipes() const {
  return {.usb_class = kUsbClass,
          .usb_subclass = kUsbSubclass,
          .usb_protocol = kUsbProtocol,
          .kind = TransferKind::kInterrupt,
          .wants_out = true,
          .least_packet_bytes = kStateBytes};
}

std::uint64_t ReferenceProtocol::silence_limit_us() const noexcept { return kSilenceUs; }

std::expected<void, UsbError> ReferenceProtocol::identify(UsbTalk& talk) {
  const auto wrong = [&](std::string_view reason) {
    return std::unexpected(usb_error(UsbFault::kWrongDevice, name(), reason));
  };
  std::array<std::uint8_t, kIdentityBytes> bytes{};
  const auto got = talk.control(
      {.type = kIdentityRequestType, .request = kIdentityRequest, .index = talk.interface_number()},
      bytes);
  if (!got && got.error() == UsbFault::kStall) return wrong("it does not say who it is");
  if (!got) return std::unexpected(usb_error(got.error(), name()));
  const auto identity = decode_identity(std::span(bytes).first(*got));
  if (!identity) return wrong("its identity is garbled");
  if (identity->version != kVersion) {
    return wrong(join({"it speaks version ", std::to_string(identity->version),
                       " of the protocol, this program version ", std::to_string(kVersion)}));
  }
  if (!is_buildable(identity->pen)) return wrong("its dimensions are impossible");
  if (identity->watchdog_ms == 0 || identity->watchdog_ms > kWatchdogMs) {
    return wrong(
        join({"its watchdog lets the motors run for ", std::to_string(identity->watchdog_ms),
              " ms, at most ", std::to_string(kWatchdogMs), " are allowed"}));
  }
  identity_ = *identity;
  return {};
}

void ReferenceProtocol::connected(std::uint64_t) noexcept {
  report_.reset();
  pose_.reset();
  mismatched_ = false;
  silent_ = false;
  sent_us_ = 0;
}

bool ReferenceProtocol::is_new(std::uint16_t sequence, std::uint64_t now_us) const noexcept {
  if (!report_) return true;
  const auto ahead = static_cast<std::int16_t>(sequence - report_->sequence);
  // A firmware that started anew counts from anywhere; one that is stuck repeats itself for ever.
  const bool forgotten = now_us - std::min(now_us, report_us_) > kForgetUs;
  return ahead > 0 || (forgotten && ahead != 0);
}

bool ReferenceProtocol::is_plausible(const PenPose& pose, std::uint64_t now_us,
                                     std::uint64_t gap_us) noexcept {
  mismatched_ = std::abs(pose.mismatch_mm) > kMismatchMm;
  if (mismatched_) return false;
  if (!pose_ || now_us - std::min(now_us, pose_us_) > kForgetUs) return true;
  // The hand had the time between two reports, not the time since the last pose that was believed:
  // a jump does not become a motion by being repeated.
  const double most_mm = kJumpMm + kMostMmPerS * static_cast<double>(gap_us) / kUsPerS;
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
  if (phase() == DevicePhase::kHoming) {
    // Angles mean nothing yet; the bytes were good.
    pose_.reset();
    return true;
  }
  const PenAngles q = angles_of(*report);
  const auto pose = turns_too_far(q) ? std::nullopt : pen_pose(identity_.pen, q);
  if (!pose || !is_plausible(*pose, now_us, gap_us)) return false;
  pose_ = pose;
  pose_us_ = now_us;
  const Vec3 grip_mm =
      place_.middle_mm + Vec3{0, 0, place_.pivot_mm} + pose->grip_mm - middle_grip(identity_.pen);
  const bool cutting = (report->buttons & kCutButton) != 0;
  const bool held = (report->buttons & kGripSensor) != 0;
  mailbox_.publish(
      {.tip_mm = grip_mm - pose->axis * place_.pivot_mm,
       .axis = pose->axis,
       .buttons = (cutting ? wire::kButtonCutting : 0U) | (held ? wire::kButtonDeadman : 0U),
       .time_us = now_us,
       .valid = true,
       .phase = phase()});
  return true;
}

CommandReport ReferenceProtocol::command(std::uint64_t now_us) noexcept {
  bool fresh = false;
  const Wrench wrench = mailbox_.wanted(now_us, fresh);
  const bool due = fresh || silent_ || now_us - std::min(now_us, sent_us_) >= kKeepAliveUs;
  if (!due) return {};
  CommandReport report{.sequence = ++sequence_, .command = kEnableMotors};
  if (silent_) {
    report.command = 0;
    return report;
  }
  if (phase() == DevicePhase::kHoming) report.command = kStartHoming;
  const bool current = pose_ && now_us - std::min(now_us, pose_us_) < HandMailbox::kPoseLifeUs;
  // After its watchdog has tripped, the firmware waits for a command without torque.
  const bool tripped = report_ && (report_->status & kWatchdogBit) != 0;
  if (phase() != DevicePhase::kReady || !current || tripped) return report;
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
  if (phase() == DevicePhase::kHoming) return "the device is finding its home position";
  if (mismatched_) return "the device's arms contradict each other; home it again";
  return {};
}

}  // namespace kerf::agent::reference
