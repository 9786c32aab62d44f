// SPDX-License-Identifier: Apache-2.0
#include "server/http/cookie.h"

#include <algorithm>
#include <cctype>

namespace kerf::net {
namespace {

constexpr std::string_view kCookieName = "kerf_pass=";
constexpr std::string_view kScheme = "bearer ";

std::string_view trimmed(std::string_view text) {
  const auto first = std::min(text.find_first_not_of(' '), text.size());
  text.remove_prefix(first);
  return text.substr(0, text.find_last_not_of(' ') + 1);
}

}  // namespace

std::string pass_cookie(std::string_view session, std::string_view token, std::int64_t lifetime_s,
                        bool is_secure) {
  std::string cookie(kCookieName);
  cookie.append(token).append("; Path=/v1/sessions/").append(session);
  cookie.append("; Max-Age=").append(std::to_string(lifetime_s));
  cookie.append("; HttpOnly; SameSite=Strict");
  if (is_secure) cookie.append("; Secure");
  return cookie;
}

std::string pass_of_cookies(std::string_view header) {
  while (!header.empty()) {
    const auto end = std::min(header.find(';'), header.size());
    const auto cookie = trimmed(header.substr(0, end));
    if (cookie.starts_with(kCookieName)) return std::string(cookie.substr(kCookieName.size()));
    header.remove_prefix(std::min(end + 1, header.size()));
  }
  return {};
}

std::string bearer_token(std::string_view header) {
  const bool is_bearer = header.size() > kScheme.size() &&
                         std::ranges::equal(header.substr(0, kScheme.size()), kScheme, {},
                                            [](unsigned char c) { return std::tolower(c); });
  return is_bearer ? std::string(trimmed(header.substr(kScheme.size()))) : std::string();
}

}  // namespace kerf::net
