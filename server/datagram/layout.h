// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <span>

#include "server/wire/limits.h"

namespace kerf::datagram {

/// The bytes `KRD1`: the last one is the major version, as in a wire frame.
inline constexpr std::uint32_t kMagic = 0x3144524B;

inline constexpr std::size_t kHeaderBytes = 16;
inline constexpr std::size_t kTagBytes = 16;
/// What every path carries in one piece: IPv6 promises 1280 bytes, of which it and UDP take 48.
inline constexpr std::size_t kMaxBytes = 1200;
inline constexpr std::size_t kMaxFrameBytes = kMaxBytes - kHeaderBytes - kTagBytes;

static_assert(wire::kHeaderBytes + wire::kListHeadBytes +
                  wire::kMaxSamplesPerMotion * wire::kSampleBytes <=
              kMaxFrameBytes);
static_assert(wire::kHeaderBytes + wire::kMaxResultBytes <= kMaxFrameBytes);

/// What stands in clear before the sealed frame, and is authenticated with it.
struct Header {
  std::uint32_t connection = 0;
  /// Per direction, from 1; never used twice with one key.
  std::uint64_t counter = 0;

  bool operator==(const Header&) const = default;
};

/// Why a datagram was dropped. No peer is ever told.
enum class Fault : std::uint8_t {
  kTooShort,
  kTooLong,
  kBadMagic,
  kOtherConnection,
  kReplayed,
  kNotAuthentic,
};

std::array<std::byte, kHeaderBytes> encode(const Header& header) noexcept;

/// The header of a datagram that is neither too short for a frame nor too long; says nothing of
/// who has sent it.
std::expected<Header, Fault> read_header(std::span<const std::byte> datagram) noexcept;

}  // namespace kerf::datagram
