// SPDX-License-Identifier: Apache-2.0
#include "tests/usb/model/falcon_model.h"

#include <algorithm>

#include "haptic_agent/device/falcon/falcon_kinematics.h"
#include "haptic_agent/device/falcon/falcon_protocol.h"

namespace kerf::usb_test {

namespace falcon = agent::falcon;

namespace {

constexpr std::array<std::uint8_t, 2> kModemStatus = {0x01, 0x60};
constexpr std::size_t kMaxData = 62;
constexpr std::uint64_t kLatencyUs = 1000;
constexpr std::uint64_t kPatienceUs = 10'000;
constexpr std::uint8_t kBaudRequest = 3;
constexpr std::uint16_t kBaud9600 = 0x4138;
constexpr std::uint16_t kBaudLoader = 0x0015;
constexpr std::uint8_t kLastFtdiRequest = 9;
constexpr std::uint8_t kVendorOut = 0x40;

}  // namespace

FalconModel::FalconModel(const Settings& settings)
    : settings_(settings), mode_(settings.has_firmware ? Mode::kRun : Mode::kAsleep) {
  hold(falcon::kMiddleMm);
}

UsbShape FalconModel::shape() const {
  return {.vendor = falcon::FalconProtocol::kId.vendor,
          .product = falcon::FalconProtocol::kId.product,
          .usb_subclass = 0xFF,
          .usb_protocol = 0xFF,
          .kind = 2};
}

std::optional<Bytes> FalconModel::control(const Setup& setup, std::span<const std::uint8_t>) {
  if (setup.type != kVendorOut || setup.request > kLastFtdiRequest) return std::nullopt;
  if (setup.request == kBaudRequest) baud_ = setup.value;
  if (setup.request == 0) packets_.clear();
  return Bytes{};
}

void FalconModel::transmit(std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const auto part = bytes.first(std::min(bytes.size(), kMaxData));
    Bytes packet(kModemStatus.begin(), kModemStatus.end());
    packet.insert(packet.end(), part.begin(), part.end());
    packets_.push_back(std::move(packet));
    bytes = bytes.subspan(part.size());
  }
}

std::optional<Bytes> FalconModel::poll_in(std::uint64_t now_us) {
  if (!packets_.empty()) {
    Bytes packet = std::move(packets_.front());
    packets_.pop_front();
    return packet;
  }
  // Without data the chip sends its status only.
  if (now_us < next_status_us_) return std::nullopt;
  next_status_us_ = now_us + kLatencyUs;
  return Bytes(kModemStatus.begin(), kModemStatus.end());
}

void FalconModel::take_out(std::span<const std::uint8_t> packet, std::uint64_t now_us) {
  constexpr std::array<std::uint8_t, 3> kWakeRequest = {0x0A, 0x43, 0x0D};
  constexpr std::array<std::uint8_t, 4> kWakeAnswer = {0x0A, 0x44, 0x2C, 0x0D};
  if (mode_ == Mode::kLoading) {
    load(packet);
  } else if (mode_ == Mode::kRun && baud_ != kBaud9600) {
    obey(packet, now_us);
  } else if (baud_ == kBaud9600 && std::ranges::equal(packet, kWakeRequest)) {
    if (++wake_requests_ <= settings_.ignored_wake_requests) {
      transmit(std::array<std::uint8_t, 1>{0x00});
      return;
    }
    mode_ = Mode::kAwake;
    transmit(kWakeAnswer);
  } else if (mode_ == Mode::kAwake && baud_ == kBaudLoader && packet.size() == 1 &&
             packet[0] == 0x41) {
    mode_ = Mode::kLoading;
    loaded_bytes_ = 0;
    ++loads_;
    transmit(packet);
  }
}

void FalconModel::load(std::span<const std::uint8_t> chunk) {
  Bytes echo(chunk.begin(), chunk.end());
  loaded_bytes_ += chunk.size();
  if (loads_ <= settings_.garbled_loads) {
    echo.back() ^= 1U;
    mode_ = Mode::kAsleep;
  } else if (loaded_bytes_ >= settings_.firmware_bytes) {
    mode_ = Mode::kRun;
  }
  transmit(echo);
}

void FalconModel::obey(std::span<const std::uint8_t> packet, std::uint64_t now_us) {
  const auto command = falcon::decode_command(packet);
  if (!command || hung_) return;
  if (!packets_.empty() && now_us - obeyed_us_ < kPatienceUs) ++impatient_;
  obeyed_us_ = now_us;
  motors_ = command->motors;
  lights_ = command->lights;
  if (++answers_ >= settings_.homing_answers) state_.homed = falcon::kAllHomed;
  falcon::FalconState reported = state_;
  if (!homed()) reported.encoders = {123, -456, 7};
  const auto frame = falcon::encode_state(reported);
  if (split_) {
    transmit(std::span(frame).first(5));
    transmit(std::span(frame).subspan(5));
  } else {
    transmit(frame);
  }
}

void FalconModel::power_cycle() {
  mode_ = settings_.has_firmware ? Mode::kRun : Mode::kAsleep;
  state_.homed = 0;
  motors_ = {};
  answers_ = wake_requests_ = 0;
  packets_.clear();
}

void FalconModel::hold(Vec3 position_mm) {
  const auto angles = falcon::leg_angles(position_mm);
  if (!angles) return;
  for (std::size_t i = 0; i < 3; ++i) state_.encoders[i] = falcon::count_of((*angles)[i]);
}

}  // namespace kerf::usb_test
