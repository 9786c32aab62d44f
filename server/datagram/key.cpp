// SPDX-License-Identifier: Apache-2.0
#include "server/datagram/key.h"

#include <openssl/rand.h>

#include <cstring>
#include <span>

namespace kerf::datagram {
namespace {

constexpr std::string_view kDigits = "0123456789abcdef";
constexpr std::size_t kBitsPerDigit = 4;

bool fill_random(std::span<std::byte> bytes) {
  return RAND_bytes(reinterpret_cast<unsigned char*>(bytes.data()),
                    static_cast<int>(bytes.size())) == 1;
}

}  // namespace

std::optional<Offer> random_offer(std::uint16_t port) {
  Offer offer{.port = port};
  std::array<std::byte, sizeof offer.connection> connection{};
  if (!fill_random(connection) || !fill_random(offer.to_server) || !fill_random(offer.to_agent)) {
    return std::nullopt;
  }
  std::memcpy(&offer.connection, connection.data(), connection.size());
  return offer;
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
