// SPDX-License-Identifier: Apache-2.0
#include "server/store/resume_token.h"

#include <openssl/crypto.h>
#include <openssl/evp.h>

#include <algorithm>

#include "server/platform/random.h"

namespace kerf {
namespace {

constexpr std::size_t kTokenBytes = 16;
constexpr std::string_view kHexDigits = "0123456789abcdef";

}  // namespace

std::optional<std::string> random_token() {
  std::array<std::byte, kTokenBytes> bytes{};
  if (!fill_random(bytes)) return std::nullopt;
  std::string token;
  for (const std::byte byte : bytes) {
    token += kHexDigits[std::to_integer<std::size_t>(byte >> 4U)];
    token += kHexDigits[std::to_integer<std::size_t>(byte & std::byte{0xF})];
  }
  return token;
}

std::optional<TokenHash> hash_token(std::string_view token) {
  const bool is_token = token.size() == 2 * kTokenBytes &&
                        std::ranges::all_of(token, [](char c) { return kHexDigits.contains(c); });
  return is_token ? hash_secret(token) : std::nullopt;
}

std::optional<TokenHash> hash_secret(std::string_view secret) {
  TokenHash hash{};
  if (EVP_Digest(secret.data(), secret.size(), reinterpret_cast<unsigned char*>(hash.data()),
                 nullptr, EVP_sha256(), nullptr) != 1) {
    return std::nullopt;
  }
  return hash;
}

bool are_equal(const TokenHash& a, const TokenHash& b) {
  return CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

}  // namespace kerf
