// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/falcon/falcon_protocol.h"

#include <algorithm>
#include <utility>

#include "haptic_agent/device/falcon/falcon_firmware.h"
#include "server/wire/types.h"

namespace kerf::agent::falcon {
namespace {

constexpr std::uint16_t kPacketBytes = 64;
/// An answer that has not come by then never will; the next command goes out.
constexpr std::uint64_t kAnswerUs = 10'000;
/// The serial chip sends its status every millisecond, whatever the Falcon does.
constexpr std::uint64_t kSilenceUs = 500'000;
/// Faster than any hand; what is beyond is a slipped encoder.
constexpr double kJumpMm = 10.0;
constexpr std::uint64_t kForgetUs = 100'000;
/// A grip farther out than this is not within the legs' reach.
constexpr double kMostMm = 200.0;

}  // namespace

FalconProtocol::FalconProtocol(FalconSettings settings) : settings_(std::move(settings)) {}

PipeWish FalconProtocol::pipes() const {
  return {.kind = TransferKind::kBulk, .wants_out = true, .least_packet_bytes = kPacketBytes};
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
          .workspace_min_mm = settings_.middle_mm - reach,
          .workspace_max_mm = settings_.middle_mm + reach,
          .has_deadman = false};
}

std::expected<void, UsbError> FalconProtocol::identify(UsbTalk& talk) {
  if (const auto done = enter_run_mode(talk); !done) {
    return std::unexpected(usb_error(done.error(), name(), "its serial chip cannot be set up"));
  }
  if (answers(talk)) return {};
  if (settings_.firmware.empty()) {
    return std::unexpected(
        UsbError{.fault = UsbFault::kWrongDevice,
                 .text = "the Novint Falcon has no firmware, which it loses with its power: give "
                         "the vendor's file with --device falcon:FILE"});
  }
  return load_firmware(talk, name(), settings_.firmware);
}

void FalconProtocol::connected(std::uint64_t) noexcept {
  reader_.reset();
  state_.reset();
  position_mm_.reset();
  waiting_ = false;
  silent_ = false;
}

bool FalconProtocol::take(std::span<const std::uint8_t> packet, std::uint64_t now_us) noexcept {
  constexpr std::size_t kStatusOnly = 2;
  if (packet.size() <= kStatusOnly) return true;
  const auto frame = reader_.take(packet);
  // A frame may come in two packets.
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
  for (std::size_t i = 0; i < angles_.size(); ++i) angles_[i] = angle_of(state_->encoders[i]);
  const bool recent = position_mm_ && now_us - std::min(now_us, pose_us_) < kForgetUs;
  const auto position = position_of(angles_, recent ? *position_mm_ : kMiddleMm);
  if (!position || length(*position) > kMostMm || position->z <= 0) return false;
  if (recent && length(*position - *position_mm_) > kJumpMm) return false;
  position_mm_ = position;
  pose_us_ = now_us;
  const bool cutting = (state_->buttons & kCentreButton) != 0;
  mailbox_.publish({.tip_mm = settings_.middle_mm + to_kerf(*position - kMiddleMm),
                    .axis = {0, 0, 1},
                    .buttons = wire::kButtonDeadman | (cutting ? wire::kButtonCutting : 0U),
                    .time_us = now_us,
                    .valid = true,
                    .phase = DevicePhase::kReady});
  return true;
}

std::array<std::int16_t, 3> FalconProtocol::motors(std::uint64_t now_us) noexcept {
  bool fresh = false;
  const Wrench wrench = mailbox_.wanted(now_us, fresh);
  const bool current =
      position_mm_ && now_us - std::min(now_us, pose_us_) < HandMailbox::kPoseLifeUs;
  if (silent_ || !homed() || !current) return {};
  const auto torques = leg_torques(angles_, *position_mm_, from_kerf(wrench.force_n));
  return torques ? motor_words(*torques) : std::array<std::int16_t, 3>{};
}

std::size_t FalconProtocol::compose(std::span<std::uint8_t> packet, std::uint64_t now_us) noexcept {
  // Strictly one answer for one command: a second command before the answer confuses the firmware.
  if (waiting_ && !silent_ && now_us - std::min(now_us, sent_us_) < kAnswerUs) return 0;
  if (packet.size() < kFrameBytes) return 0;
  // The serial chip goes on without its firmware; what the firmware said last is then worth
  // nothing.
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
  return "the Falcon does not know its position: push its grip all the way in, then pull it all "
         "the way out, until its light turns from red to green";
}

}  // namespace kerf::agent::falcon
