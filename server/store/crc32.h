// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace kerf {

namespace crc32_detail {
constexpr std::array<std::uint32_t, 256> make_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t value = i;
    for (int bit = 0; bit < 8; ++bit) {
      value = (value >> 1) ^ ((value & 1) != 0 ? 0xEDB88320U : 0U);
    }
    table[i] = value;
  }
  return table;
}
inline constexpr std::array<std::uint32_t, 256> kTable = make_table();
}  // namespace crc32_detail

/// Computes the CRC-32 of IEEE 802.3, like zlib. `seed`: the CRC of the preceding bytes, 0 at the
/// start.
constexpr std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t seed = 0) {
  std::uint32_t value = ~seed;
  for (const std::byte byte : bytes) {
    value =
        (value >> 8) ^ crc32_detail::kTable[(value ^ std::to_integer<std::uint32_t>(byte)) & 0xFFU];
  }
  return ~value;
}

}  // namespace kerf
