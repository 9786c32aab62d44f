// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace kerf::datagram {

/// The cipher's name in the welcome.
inline constexpr std::string_view kCipherName = "chacha20-poly1305";

inline constexpr std::size_t kKeyBytes = 32;
using Key = std::array<std::byte, kKeyBytes>;

/// The parameters of a UDP connection, sent in the welcome and valid until the WebSocket closes.
struct Offer {
  std::uint16_t port = 0;
  std::uint32_t connection = 0;
  Key to_server{}, to_agent{};

  bool operator==(const Offer&) const = default;
};

/// Creates an offer with a random connection number and random keys, or nullopt if the system's
/// random generator fails.
std::optional<Offer> random_offer(std::uint16_t port);

/// Returns a key as 64 lowercase hexadecimal digits, its form in the welcome.
std::string to_text(const Key& key);
/// The inverse of to_text(), or nullopt for any other text.
std::optional<Key> key_from_text(std::string_view text);

}  // namespace kerf::datagram
