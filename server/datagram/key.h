// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace kerf::datagram {

/// As the welcome names it.
inline constexpr std::string_view kCipherName = "chacha20-poly1305";

inline constexpr std::size_t kKeyBytes = 32;
using Key = std::array<std::byte, kKeyBytes>;

/// What a server tells an agent over the WebSocket, and both forget when that closes.
struct Offer {
  std::uint16_t port = 0;
  std::uint32_t connection = 0;
  Key to_server{}, to_agent{};

  bool operator==(const Offer&) const = default;
};

/// An offer with a random connection and random keys; none if the system has no randomness to give.
std::optional<Offer> random_offer(std::uint16_t port);

/// As it stands in the welcome: 64 hexadecimal digits, lower case.
std::string to_text(const Key& key);
std::optional<Key> key_from_text(std::string_view text);

}  // namespace kerf::datagram
