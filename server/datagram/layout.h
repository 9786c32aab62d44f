// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <span>

#include "server/wire/limits.h"

namespace kerf::datagram {

/// The bytes `KRD1`. The last digit is the major version, as in a wire frame.
inline constexpr std::uint32_t kMagic = 0x3144524B;

inline constexpr std::size_t kHeaderBytes = 16;
inline constexpr std::size_t kTagBytes = 16;
/// Fits every path without fragmentation: IPv6 guarantees 1280 bytes, and its header and UDP's take
/// 48 of them.
inline constexpr std::size_t kMaxBytes = 1200;
inline constexpr std::size_t kMaxFrameBytes = kMaxBytes - kHeaderBytes - kTagBytes;

static_assert(wire::kHeaderBytes + wire::kListHeadBytes +
                  wire::kMaxSamplesPerMotion * wire::kSampleBytes <=
              kMaxFrameBytes);
static_assert(wire::kDurableHeaderBytes + wire::kMaxResultBytes <= kMaxFrameBytes);

/// The header of a datagram: not encrypted, but authenticated together with the frame.
struct Header {
  std::uint32_t connection = 0;
  /// Per direction, from 1; never reused with the same key.
  std::uint64_t counter = 0;

  bool operator==(const Header&) const = default;
};

/// Why a datagram was dropped. Faults are counted and never reported to a peer.
enum class Fault : std::uint8_t {
  kTooShort,
  kTooLong,
  kBadMagic,
  kOtherConnection,
  kReplayed,
  kNotAuthentic,
};

std::array<std::byte, kHeaderBytes> encode(const Header& header) noexcept;

/// Parses the header and checks the size of a datagram. Does not authenticate it.
std::expected<Header, Fault> read_header(std::span<const std::byte> datagram) noexcept;

}  // namespace kerf::datagram
