// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/falcon/falcon_protocol.h"

#include <algorithm>
#include <utility>

#include "haptic_agent/device/falcon/falcon_firmware.h"
#include "haptic_agent/device/units.h"
#include "server/wire/types.h"

namespace kerf::agent::falcon {
namespace {

/// Timeout of an answer; after it the next command is sent.
constexpr std::uint64_t kAnswerUs = 10'000;
/// The serial chip sends its status every millisecond, independently of the firmware.
constexpr std::uint64_t kSilenceUs = 500'000;
/// A request and a reply through the serial chip, whose latency timer is 1 ms.
constexpr std::uint64_t kLatencyUs = 3000;
/// Resolution of the pose as estimated between the counts. Each count moves the grip by 0.04 mm.
constexpr double kResolutionMm = 0.001;
/// Assumed mass of the grip and its three legs. The grip does not turn, so no torque moves it.
constexpr double kMovingMassKg = 0.1;
constexpr double kMovingInertiaKgM2 = 1;
/// Largest plausible movement between two poses. A larger one means that an encoder slipped.
constexpr double kJumpMm = 10.0;
constexpr std::uint64_t kForgetUs = 100'000;
/// Positions farther away than this are out of the legs' reach.
constexpr double kMaxMm = 200.0;

}  // namespace

FalconProtocol::FalconProtocol(FalconSettings settings) : settings_(std::move(settings)) {}

PipeRequirements FalconProtocol::required_pipes() const {
  return {.kind = TransferKind::kBulk, .needs_out = true, .min_packet_bytes = kPacketBytes};
}

std::uint64_t FalconProtocol::silence_limit_us() const noexcept { return kSilenceUs; }

DeviceCapabilities FalconProtocol::capabilities() const {
  const Vec3 reach{kReachMm, kReachMm, kReachMm};
  return {.name = "Novint Falcon",
          .sensed_dof = 3,
          .actuated_dof = 3,
          .max_force_n = 8.0,
          .max_stiffness_n_per_mm = 3.0,
          .max_damping_n_s_per_mm = 0.02,
          .latency_us = kLatencyUs,
          .resolution_mm = kResolutionMm,
          .moving_mass_kg = kMovingMassKg,
          .moving_inertia_kg_m2 = kMovingInertiaKgM2,
          .workspace_min_mm = settings_.middle_mm - reach,
          .workspace_max_mm = settings_.middle_mm + reach,
          .has_deadman = false};
}

std::expected<void, UsbError> FalconProtocol::identify(UsbSyncIo& io) {
  if (const auto done = enter_run_mode(io); !done) {
    return std::unexpected(usb_error(done.error(), name(), "its serial chip cannot be configured"));
  }
  if (answers(io)) return {};
  if (settings_.firmware.empty()) {
    return std::unexpected(
        UsbError{.fault = UsbFault::kWrongDevice,
                 .text = "the Novint Falcon has no firmware, which it loses with its power: pass "
                         "the vendor's file by --device falcon:FILE"});
  }
  return load_firmware(io, name(), settings_.firmware);
}

void FalconProtocol::connected(std::uint64_t) noexcept {
  reader_.reset();
  state_.reset();
  position_mm_.reset();
  legs_.reset();
  waiting_ = false;
  motors_disabled_ = false;
}

bool FalconProtocol::take(std::span<const std::uint8_t> packet, std::uint64_t now_us) noexcept {
  constexpr std::size_t kStatusOnly = 2;
  if (packet.size() <= kStatusOnly) return true;
  const auto frame = reader_.take(packet);
  // A frame may be split into two packets.
  if (!frame) return packet.size() < kFrameBytes + kStatusOnly;
  const auto state = decode_state(*frame);
  if (!state) return false;
  waiting_ = false;
  answered_us_ = now_us;
  state_ = *state;
  if (!homed()) {
    position_mm_.reset();
    return true;
  }
  const std::uint64_t since_us = now_us - std::min(now_us, pose_us_);
  const bool recent = position_mm_ && since_us < kForgetUs;
  if (!recent) legs_.reset();
  angles_ = legs_.take(state_->encoders, static_cast<double>(since_us) * kSPerUs);
  const auto position = position_of(angles_, recent ? *position_mm_ : kMiddleMm);
  if (!position || length(*position) > kMaxMm || position->z <= 0) return false;
  if (recent && length(*position - *position_mm_) > kJumpMm) return false;
  position_mm_ = position;
  pose_us_ = now_us;
  const bool cutting = (state_->buttons & kCenterButton) != 0;
  const bool clutch = (state_->buttons & kSmallButtons) != 0;
  mailbox_.publish({.tip_mm = settings_.middle_mm + to_kerf(*position - kMiddleMm),
                    .axis = {0, 0, 1},
                    .buttons = wire::kButtonDeadman | (cutting ? wire::kButtonCutting : 0U) |
                               (clutch ? kButtonClutch : 0U),
                    .time_us = now_us,
                    .valid = true,
                    .phase = DevicePhase::kReady});
  return true;
}

std::array<std::int16_t, 3> FalconProtocol::motors(std::uint64_t now_us) noexcept {
  bool changed = false;
  const Wrench wrench = mailbox_.output(now_us, changed);
  const bool current =
      position_mm_ && now_us - std::min(now_us, pose_us_) < DeviceMailbox::kPoseLifeUs;
  if (motors_disabled_ || !homed() || !current) return {};
  const auto torques = leg_torques(angles_, *position_mm_, from_kerf(wrench.force_n));
  return torques ? motor_words(*torques) : std::array<std::int16_t, 3>{};
}

std::size_t FalconProtocol::compose(std::span<std::uint8_t> packet, std::uint64_t now_us) noexcept {
  // One command per answer: the firmware fails if it receives a command before it has answered the
  // last.
  if (waiting_ && !motors_disabled_ && now_us - std::min(now_us, sent_us_) < kAnswerUs) return 0;
  if (packet.size() < kFrameBytes) return 0;
  // The serial chip keeps sending when the firmware hangs. The last state is then outdated.
  if (now_us - std::min(now_us, answered_us_) > kSilenceUs) state_.reset();
  const std::uint8_t lights = homed() ? kGreenLight : (kRedLight | kHomingMode);
  std::ranges::copy(encode_command(motors(now_us), lights), packet.begin());
  waiting_ = true;
  sent_us_ = now_us;
  return kFrameBytes;
}

void FalconProtocol::disconnected() noexcept {
  state_.reset();
  position_mm_.reset();
  mailbox_.stop();
}

DevicePhase FalconProtocol::phase() const noexcept {
  return homed() ? DevicePhase::kReady : DevicePhase::kHoming;
}

std::string_view FalconProtocol::trouble() const noexcept {
  if (homed()) return {};
  return "the Falcon is not homed: push its grip in completely, then pull it out completely, until "
         "its light turns from red to green";
}

}  // namespace kerf::agent::falcon
