// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/reference/report.h"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>

namespace kerf::agent::reference {
namespace {

constexpr std::uint8_t kStateKind = 0x4B;
constexpr std::uint8_t kCommandKind = 0x43;
constexpr std::array<std::uint8_t, 4> kMagic = {'K', 'E', 'R', 'F'};
constexpr double kUmPerMm = 1000.0;
constexpr double kRadPerUrad = 1e-6;
constexpr double kStepsPerNmm = 10.0;
constexpr std::size_t kChecksumBytes = 4;
constexpr std::size_t kHeadBytes = 6;

/// Writes consecutive little-endian numbers.
class Writer {
 public:
  explicit Writer(std::span<std::uint8_t> bytes) : bytes_(bytes) {}
  template <std::integral T>
  void put(T value) noexcept {
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bytes_[at_++] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i));
    }
  }
  void put_mm(double mm) noexcept { put(static_cast<std::int32_t>(std::lround(mm * kUmPerMm))); }
  void put_checksum() noexcept { put(crc32(bytes_.first(at_))); }

 private:
  std::span<std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  template <std::integral T>
  T take() noexcept {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      value |= static_cast<std::uint64_t>(bytes_[at_++]) << (8 * i);
    }
    return static_cast<T>(value);
  }
  double take_mm() noexcept { return take<std::int32_t>() / kUmPerMm; }
  Vec3 take_point() noexcept {
    const double x = take_mm(), y = take_mm();
    return {x, y, take_mm()};
  }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
};

bool has_valid_checksum(std::span<const std::uint8_t> bytes) noexcept {
  const auto body = bytes.first(bytes.size() - kChecksumBytes);
  return Reader(bytes.last(kChecksumBytes)).take<std::uint32_t>() == crc32(body);
}

bool is_report(std::span<const std::uint8_t> bytes, std::size_t size, std::uint8_t kind) noexcept {
  return bytes.size() == size && bytes[0] == kind && bytes[1] == kVersion &&
         has_valid_checksum(bytes);
}

void put_arm(Writer& out, const ArmShape& arm) noexcept {
  for (const double mm : {arm.base_mm.x, arm.base_mm.y, arm.base_mm.z, arm.upper_mm, arm.fore_mm}) {
    out.put_mm(mm);
  }
}

ArmShape take_arm(Reader& in) noexcept {
  ArmShape arm{.base_mm = in.take_point()};
  arm.upper_mm = in.take_mm();
  arm.fore_mm = in.take_mm();
  return arm;
}

}  // namespace

std::uint32_t crc32(std::span<const std::uint8_t> bytes) noexcept {
  constexpr std::uint32_t kReversedPolynomial = 0xEDB88320;
  std::uint32_t sum = 0xFFFFFFFF;
  for (const std::uint8_t byte : bytes) {
    sum ^= byte;
    for (int bit = 0; bit < 8; ++bit) {
      sum = (sum >> 1) ^ ((sum & 1U) != 0 ? kReversedPolynomial : 0U);
    }
  }
  return ~sum;
}

std::array<std::uint8_t, kIdentityBytes> encode(const Identity& identity) noexcept {
  std::array<std::uint8_t, kIdentityBytes> bytes{};
  Writer out(bytes);
  for (const std::uint8_t letter : kMagic) out.put(letter);
  out.put(identity.version);
  out.put(identity.minor);
  out.put(identity.firmware);
  out.put(identity.serial);
  put_arm(out, identity.pen.front);
  put_arm(out, identity.pen.rear);
  out.put_mm(identity.pen.length_mm);
  out.put_mm(identity.pen.grip_mm);
  for (const double nmm : identity.torque_max_nmm) {
    out.put(static_cast<std::uint16_t>(std::lround(nmm * kStepsPerNmm)));
  }
  out.put(identity.period_us);
  out.put(identity.watchdog_ms);
  out.put(std::uint32_t{0});
  out.put_checksum();
  return bytes;
}

std::array<std::uint8_t, kStateBytes> encode(const StateReport& report) noexcept {
  std::array<std::uint8_t, kStateBytes> bytes{};
  Writer out(bytes);
  out.put(kStateKind);
  out.put(kVersion);
  out.put(report.sequence);
  out.put(report.time_us);
  out.put(report.status);
  out.put(report.buttons);
  for (const std::int32_t angle : report.angles_urad) out.put(angle);
  out.put(report.accepted);
  out.put(report.rejected);
  out.put(report.temperature_dc);
  out.put(std::uint16_t{0});
  out.put_checksum();
  return bytes;
}

std::array<std::uint8_t, kCommandBytes> encode(const CommandReport& report) noexcept {
  std::array<std::uint8_t, kCommandBytes> bytes{};
  Writer out(bytes);
  out.put(kCommandKind);
  out.put(kVersion);
  out.put(report.sequence);
  out.put(report.command);
  for (const std::int16_t torque : report.torques_dnmm) out.put(torque);
  out.put(std::uint16_t{0});
  out.put_checksum();
  return bytes;
}

std::optional<Identity> decode_identity(std::span<const std::uint8_t> bytes) noexcept {
  if (bytes.size() < kHeadBytes || !std::ranges::equal(bytes.first(kMagic.size()), kMagic)) {
    return std::nullopt;
  }
  Reader in(bytes.subspan(kMagic.size()));
  Identity identity{.version = in.take<std::uint8_t>(), .minor = in.take<std::uint8_t>()};
  if (identity.version != kVersion) return identity;
  if (bytes.size() != kIdentityBytes || !has_valid_checksum(bytes)) return std::nullopt;
  identity.firmware = in.take<std::uint16_t>();
  identity.serial = in.take<std::uint32_t>();
  identity.pen.front = take_arm(in);
  identity.pen.rear = take_arm(in);
  identity.pen.length_mm = in.take_mm();
  identity.pen.grip_mm = in.take_mm();
  for (double& nmm : identity.torque_max_nmm) nmm = in.take<std::uint16_t>() / kStepsPerNmm;
  identity.period_us = in.take<std::uint16_t>();
  identity.watchdog_ms = in.take<std::uint16_t>();
  return identity;
}

std::optional<StateReport> decode_state(std::span<const std::uint8_t> bytes) noexcept {
  if (!is_report(bytes, kStateBytes, kStateKind)) return std::nullopt;
  Reader in(bytes.subspan(2));
  StateReport report{.sequence = in.take<std::uint16_t>(), .time_us = in.take<std::uint32_t>()};
  report.status = in.take<std::uint16_t>();
  report.buttons = in.take<std::uint16_t>();
  for (std::int32_t& angle : report.angles_urad) angle = in.take<std::int32_t>();
  report.accepted = in.take<std::uint16_t>();
  report.rejected = in.take<std::uint16_t>();
  report.temperature_dc = in.take<std::int16_t>();
  return report;
}

std::optional<CommandReport> decode_command(std::span<const std::uint8_t> bytes) noexcept {
  if (!is_report(bytes, kCommandBytes, kCommandKind)) return std::nullopt;
  Reader in(bytes.subspan(2));
  CommandReport report{.sequence = in.take<std::uint16_t>(), .command = in.take<std::uint16_t>()};
  for (std::int16_t& torque : report.torques_dnmm) torque = in.take<std::int16_t>();
  return report;
}

PenAngles angles_of(const StateReport& report) noexcept {
  PenAngles q;
  for (std::size_t i = 0; i < 3; ++i) {
    q.front[i] = report.angles_urad[i] * kRadPerUrad;
    q.rear[i] = report.angles_urad[i + 3] * kRadPerUrad;
  }
  return q;
}

std::array<std::int16_t, 6> wire_torques(const std::array<double, 6>& torques_nmm,
                                         const std::array<double, 6>& most_nmm) noexcept {
  constexpr double kWireMostNmm = std::numeric_limits<std::int16_t>::max() / kStepsPerNmm;
  double share = 1;
  for (std::size_t i = 0; i < torques_nmm.size(); ++i) {
    if (!std::isfinite(torques_nmm[i])) return {};
    const double size = std::abs(torques_nmm[i]);
    const double most = std::min(most_nmm[i], kWireMostNmm);
    if (size > most) share = std::min(share, most / size);
  }
  std::array<std::int16_t, 6> wire{};
  for (std::size_t i = 0; i < wire.size(); ++i) {
    const double most = std::floor(std::min(most_nmm[i], kWireMostNmm) * kStepsPerNmm);
    const double steps = std::round(torques_nmm[i] * share * kStepsPerNmm);
    wire[i] = static_cast<std::int16_t>(std::clamp(steps, -most, most));
  }
  return wire;
}

}  // namespace kerf::agent::reference
