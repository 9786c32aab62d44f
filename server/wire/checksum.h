// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace kerf::wire {

/// Returns a checksum of bytes, as defined for mesh frames in README.md. `start` is the checksum of
/// the preceding bytes. Each step is a bijection of the checksum and of the word, so a change
/// within one four-byte word is always detected, any other except once in 2^32. It is not a
/// signature: deliberate changes can include the checksum.
constexpr std::uint32_t checksum(std::span<const std::byte> bytes,
                                 std::uint32_t start = 0) noexcept {
  std::uint32_t sum = start;
  for (std::size_t at = 0; at < bytes.size(); at += 4) {
    std::uint32_t word = 0;
    for (std::size_t n = std::min<std::size_t>(4, bytes.size() - at); n > 0; --n) {
      word = word << 8U | std::to_integer<std::uint32_t>(bytes[at + n - 1]);
    }
    sum = (sum ^ word) * 0x9E3779B1U;
    sum ^= sum >> 15U;
  }
  return sum;
}

}  // namespace kerf::wire
