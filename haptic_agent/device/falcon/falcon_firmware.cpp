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

// Vendor requests of the FTDI chip.
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

constexpr std::size_t kChunkBytes = kPacketBytes - kModemBytes;
constexpr unsigned kTimeoutMs = 200;
/// Number of consecutive packets with only the modem status after which no answer is expected.
constexpr int kMaxEmptyPackets = 50;
constexpr int kMaxWakeAttempts = 100;
constexpr int kMaxAttempts = 10;
constexpr std::size_t kMaxFirmwareBytes = std::size_t{1} << 20;

constexpr std::array<std::uint8_t, 3> kWakeRequest = {0x0A, 0x43, 0x0D};
constexpr std::array<std::uint8_t, 4> kWakeAnswer = {0x0A, 0x44, 0x2C, 0x0D};
constexpr std::array<std::uint8_t, 1> kLoad = {0x41};

using Bytes = std::vector<std::uint8_t>;
using Result = std::expected<void, UsbFault>;

Result send_request(UsbSyncIo& io, std::uint8_t request, std::uint16_t value) {
  const auto sent = io.control({.type = kVendorOut, .request = request, .value = value}, {});
  if (!sent) return std::unexpected(sent.error());
  return {};
}

Result send_requests(UsbSyncIo& io,
                     std::initializer_list<std::pair<std::uint8_t, std::uint16_t>> settings) {
  for (const auto& [request, value] : settings) {
    if (auto done = send_request(io, request, value); !done) return done;
  }
  return {};
}

/// Receives at least `bytes` bytes, without the modem status; fewer on a timeout.
Bytes receive(UsbSyncIo& io, std::size_t bytes) {
  Bytes received;
  std::array<std::uint8_t, kPacketBytes> packet{};
  for (int empty = 0; received.size() < bytes && empty < kMaxEmptyPackets && !io.stopping();) {
    const auto got = io.read(packet, kTimeoutMs);
    if (!got) break;
    if (*got <= kModemBytes) {
      ++empty;
      continue;
    }
    received.insert(received.end(), packet.begin() + kModemBytes,
                    packet.begin() + static_cast<std::ptrdiff_t>(*got));
  }
  return received;
}

bool wake_loader(UsbSyncIo& io) {
  for (int i = 0; i < kMaxWakeAttempts && !io.stopping(); ++i) {
    if (!io.write(kWakeRequest, kTimeoutMs)) return false;
    const Bytes received = receive(io, kWakeAnswer.size());
    // Some systems send a leading zero.
    if (!std::ranges::search(received, kWakeAnswer).empty()) return true;
  }
  return false;
}

/// Makes one attempt to load the firmware. Returns the failed step, or an empty text on success.
std::string_view attempt(UsbSyncIo& io, std::span<const std::uint8_t> firmware) {
  const bool set_up = send_requests(io, {{kReset, kPurgeRead},
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
  if (!wake_loader(io)) return "waking its loader";
  if (!send_requests(io, {{kModemControl, kDtrLow}, {kBaudRate, kBaudLoader}})) {
    return "setting up its serial chip";
  }
  if (!io.write(kLoad, kTimeoutMs) || receive(io, 1) != Bytes(kLoad.begin(), kLoad.end())) {
    return "starting its loader";
  }
  while (!firmware.empty()) {
    const auto chunk = firmware.first(std::min(firmware.size(), kChunkBytes));
    if (!io.write(chunk, kTimeoutMs)) return "sending the firmware";
    if (!std::ranges::equal(receive(io, chunk.size()), chunk)) return "checking its echo";
    firmware = firmware.subspan(chunk.size());
  }
  return {};
}

}  // namespace

std::expected<void, UsbFault> enter_run_mode(UsbSyncIo& io) {
  return send_requests(
      io, {{kLatencyTimer, 1}, {kBaudRate, kBaudRun}, {kReset, kPurgeRead}, {kReset, kPurgeWrite}});
}

bool answers(UsbSyncIo& io) {
  if (!io.write(encode_command({}, kRedLight | kHomingMode), kTimeoutMs)) return false;
  const Bytes received = receive(io, kFrameBytes);
  return received.size() >= kFrameBytes && decode_state(std::span(received).last(kFrameBytes));
}

std::expected<void, UsbError> load_firmware(UsbSyncIo& io, std::string_view device,
                                            std::span<const std::uint8_t> firmware) {
  std::string_view step;
  for (int i = 0; i < kMaxAttempts && !io.stopping(); ++i) {
    step = attempt(io, firmware);
    if (step.empty() && enter_run_mode(io) && answers(io)) return {};
    if (step.empty()) step = "waiting for its first answer";
  }
  return std::unexpected(
      usb_error(UsbFault::kTimeout, device,
                join({"loading its firmware failed ", std::to_string(kMaxAttempts),
                      " times, the last time while ", step,
                      "; switch it off and on, and connect it directly to the computer"})));
}

std::expected<std::vector<std::uint8_t>, std::string> read_firmware(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file || bytes.empty()) return std::unexpected(path + ": cannot be read or is empty");
  if (bytes.size() > kMaxFirmwareBytes) {
    return std::unexpected(path + ": a Falcon firmware must not be larger than 1 MiB");
  }
  return bytes;
}

}  // namespace kerf::agent::falcon
