// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/falcon/falcon_firmware.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <initializer_list>
#include <iterator>
#include <utility>

#include "haptic_agent/device/falcon/falcon_frame.h"
#include "haptic_agent/device/text_fields.h"

namespace kerf::agent::falcon {
namespace {

// Requests of the FTDI chip (vendor, device).
constexpr std::uint8_t kVendorOut = 0x40;
constexpr std::uint8_t kReset = 0;
constexpr std::uint8_t kModemControl = 1;
constexpr std::uint8_t kFlowControl = 2;
constexpr std::uint8_t kBaudRate = 3;
constexpr std::uint8_t kLineFormat = 4;
constexpr std::uint8_t kLatencyTimer = 9;
constexpr std::uint16_t kPurgeRead = 1;
constexpr std::uint16_t kPurgeWrite = 2;
constexpr std::uint16_t kDtrLow = 0x0100;
constexpr std::uint16_t kDtrHigh = 0x0101;
constexpr std::uint16_t kRtsLow = 0x0200;
constexpr std::uint16_t kEightBitsNoParity = 8;
constexpr std::uint16_t kBaud9600 = 0x4138;
constexpr std::uint16_t kBaudLoader = 0x0015;
constexpr std::uint16_t kBaudRun = 0x0002;

constexpr std::size_t kModemBytes = 2;
constexpr std::size_t kPacketBytes = 64;
constexpr std::size_t kChunkBytes = kPacketBytes - kModemBytes;
constexpr unsigned kTimeoutMs = 200;
/// Packets that hold no more than the modem's status, before the answer is given up.
constexpr int kMostEmptyPackets = 50;
constexpr int kMostKnocks = 100;
constexpr int kMostAttempts = 10;
constexpr std::size_t kMostFirmwareBytes = std::size_t{1} << 20;

constexpr std::array<std::uint8_t, 3> kKnock = {0x0A, 0x43, 0x0D};
constexpr std::array<std::uint8_t, 4> kKnockAnswer = {0x0A, 0x44, 0x2C, 0x0D};
constexpr std::array<std::uint8_t, 1> kLoad = {0x41};

using Bytes = std::vector<std::uint8_t>;
using Done = std::expected<void, UsbFault>;

Done set(UsbTalk& talk, std::uint8_t request, std::uint16_t value) {
  const auto sent = talk.control({.type = kVendorOut, .request = request, .value = value}, {});
  if (!sent) return std::unexpected(sent.error());
  return {};
}

Done set_all(UsbTalk& talk,
             std::initializer_list<std::pair<std::uint8_t, std::uint16_t>> settings) {
  for (const auto& [request, value] : settings) {
    if (auto done = set(talk, request, value); !done) return done;
  }
  return {};
}

/// At least `bytes` bytes without the modem's status; fewer if no more come.
Bytes listen(UsbTalk& talk, std::size_t bytes) {
  Bytes heard;
  std::array<std::uint8_t, kPacketBytes> packet{};
  for (int empty = 0; heard.size() < bytes && empty < kMostEmptyPackets && !talk.stopping();) {
    const auto got = talk.read(packet, kTimeoutMs);
    if (!got) break;
    if (*got <= kModemBytes) {
      ++empty;
      continue;
    }
    heard.insert(heard.end(), packet.begin() + kModemBytes,
                 packet.begin() + static_cast<std::ptrdiff_t>(*got));
  }
  return heard;
}

bool knock(UsbTalk& talk) {
  for (int i = 0; i < kMostKnocks && !talk.stopping(); ++i) {
    if (!talk.write(kKnock, kTimeoutMs)) return false;
    const Bytes heard = listen(talk, kKnockAnswer.size());
    // A leading zero comes on some systems and not on others.
    if (!std::ranges::search(heard, kKnockAnswer).empty()) return true;
  }
  return false;
}

/// Empty: loaded.
std::string_view attempt(UsbTalk& talk, std::span<const std::uint8_t> firmware) {
  const bool set_up = set_all(talk, {{kReset, kPurgeRead},
                                     {kReset, kPurgeWrite},
                                     {kLatencyTimer, 16},
                                     {kBaudRate, kBaud9600},
                                     {kLineFormat, kEightBitsNoParity},
                                     {kFlowControl, 0},
                                     {kModemControl, kRtsLow},
                                     {kModemControl, kDtrLow},
                                     {kModemControl, kDtrHigh}})
                          .has_value();
  if (!set_up) return "setting up its serial chip";
  if (!knock(talk)) return "waking its loader";
  if (!set_all(talk, {{kModemControl, kDtrLow}, {kBaudRate, kBaudLoader}})) {
    return "setting up its serial chip";
  }
  if (!talk.write(kLoad, kTimeoutMs) || listen(talk, 1) != Bytes(kLoad.begin(), kLoad.end())) {
    return "starting its loader";
  }
  while (!firmware.empty()) {
    const auto chunk = firmware.first(std::min(firmware.size(), kChunkBytes));
    if (!talk.write(chunk, kTimeoutMs)) return "sending the firmware";
    if (!std::ranges::equal(listen(talk, chunk.size()), chunk)) return "checking its echo";
    firmware = firmware.subspan(chunk.size());
  }
  return {};
}

}  // namespace

std::expected<void, UsbFault> enter_run_mode(UsbTalk& talk) {
  return set_all(
      talk,
      {{kLatencyTimer, 1}, {kBaudRate, kBaudRun}, {kReset, kPurgeRead}, {kReset, kPurgeWrite}});
}

bool answers(UsbTalk& talk) {
  if (!talk.write(encode_command({}, kRedLight | kHomingMode), kTimeoutMs)) return false;
  const Bytes heard = listen(talk, kFrameBytes);
  return heard.size() >= kFrameBytes && decode_state(std::span(heard).last(kFrameBytes));
}

std::expected<void, UsbError> load_firmware(UsbTalk& talk, std::string_view device,
                                            std::span<const std::uint8_t> firmware) {
  std::string_view step;
  for (int i = 0; i < kMostAttempts && !talk.stopping(); ++i) {
    step = attempt(talk, firmware);
    if (step.empty() && enter_run_mode(talk) && answers(talk)) return {};
    if (step.empty()) step = "waiting for its first answer";
  }
  return std::unexpected(
      usb_error(UsbFault::kTimeout, device,
                join({"loading its firmware failed ", std::to_string(kMostAttempts),
                      " times, the last time while ", step,
                      "; switch it off and on, and use a port of the computer itself"})));
}

std::expected<std::vector<std::uint8_t>, std::string> read_firmware(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file || bytes.empty()) return std::unexpected(path + ": cannot be read, or is empty");
  if (bytes.size() > kMostFirmwareBytes) {
    return std::unexpected(path + ": is larger than 1 MiB, which no Falcon firmware is");
  }
  return bytes;
}

}  // namespace kerf::agent::falcon
