// SPDX-License-Identifier: Apache-2.0
#include "server/rights/access_token.h"

namespace kerf {
namespace {

constexpr std::string_view kPrefix = "kerf_";

}  // namespace

std::optional<AccessToken> new_access_token() {
  auto id = random_token();
  auto secret = random_token();
  if (!id || !secret) return std::nullopt;
  id->resize(AccessToken::kIdDigits);
  return AccessToken{*std::move(id), *std::move(secret)};
}

std::optional<AccessToken> parse_access_token(std::string_view text) {
  if (!text.starts_with(kPrefix)) return std::nullopt;
  text.remove_prefix(kPrefix.size());
  const auto end = text.find('_');
  if (end != AccessToken::kIdDigits) return std::nullopt;
  return AccessToken{std::string(text.substr(0, end)), std::string(text.substr(end + 1))};
}

}  // namespace kerf
