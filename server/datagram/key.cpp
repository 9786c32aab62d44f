// SPDX-License-Identifier: Apache-2.0
#include "server/datagram/key.h"

#include <span>

#include "server/platform/random.h"

namespace kerf::datagram {
namespace {

constexpr std::string_view kDigits = "0123456789abcdef";
constexpr std::size_t kBitsPerDigit = 4;

}  // namespace

std::optional<Offer> random_offer(std::uint16_t port) {
  Offer offer{.port = port};
  const bool is_random = fill_random(std::as_writable_bytes(std::span(&offer.connection, 1))) &&
                         fill_random(offer.to_server) && fill_random(offer.to_agent);
  return is_random ? std::optional(offer) : std::nullopt;
}

std::string to_text(const Key& key) {
  std::string text;
  for (const std::byte byte : key) {
    text += kDigits[std::to_integer<std::size_t>(byte >> kBitsPerDigit)];
    text += kDigits[std::to_integer<std::size_t>(byte & std::byte{0xF})];
  }
  return text;
}

std::optional<Key> key_from_text(std::string_view text) {
  Key key{};
  if (text.size() != 2 * key.size()) return std::nullopt;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::size_t digit = kDigits.find(text[i]);
    if (digit == kDigits.npos) return std::nullopt;
    key[i / 2] = (key[i / 2] << kBitsPerDigit) | static_cast<std::byte>(digit);
  }
  return key;
}

}  // namespace kerf::datagram
