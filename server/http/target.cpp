// SPDX-License-Identifier: Apache-2.0
// Parsing of HTTP request targets.
#include <cctype>

#include "server/http/api_call.h"

namespace kerf::net {
namespace {

constexpr std::size_t kTargetBytesMax = 2048;
constexpr std::size_t kSegmentsMax = 16;

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  const int lower = std::tolower(static_cast<unsigned char>(c));
  return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

std::expected<std::string, std::string> decode(std::string_view text, bool plus_is_space) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '+' && plus_is_space) {
      decoded += ' ';
    } else if (text[i] != '%') {
      decoded += text[i];
    } else {
      const int high = i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
      const int low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
      if (high < 0 || low < 0)
        return std::unexpected("% must be followed by two hexadecimal digits");
      decoded += static_cast<char>(high * 16 + low);
      i += 2;
    }
  }
  if (decoded.find('\0') != std::string::npos) return std::unexpected("NUL bytes are not allowed");
  return decoded;
}

}  // namespace

std::expected<ApiRequest, std::string> parse_target(std::string_view target) {
  if (target.size() > kTargetBytesMax)
    return std::unexpected("the target is longer than 2048 bytes");
  if (target.empty() || target.front() != '/')
    return std::unexpected("the target must start with /");
  ApiRequest request;
  request.target = target;
  std::string_view path = target.substr(0, target.find('?'));
  std::string_view query = path.size() < target.size() ? target.substr(path.size() + 1) : "";
  path.remove_prefix(1);
  while (!path.empty()) {
    const auto segment = path.substr(0, path.find('/'));
    auto decoded = decode(segment, false);
    if (!decoded) return std::unexpected(decoded.error());
    if (request.path.size() == kSegmentsMax)
      return std::unexpected("the path has more than 16 segments");
    request.path.push_back(*std::move(decoded));
    path.remove_prefix(std::min(segment.size() + 1, path.size()));
  }
  for (std::string_view pair; !query.empty();
       query.remove_prefix(std::min(pair.size() + 1, query.size()))) {
    pair = query.substr(0, query.find('&'));
    if (pair.empty()) continue;
    const auto name = pair.substr(0, pair.find('='));
    auto key = decode(name, true);
    auto value = decode(name.size() < pair.size() ? pair.substr(name.size() + 1) : "", true);
    if (!key || !value) return std::unexpected("the query string is malformed");
    if (!request.query.emplace(*key, *value).second) request.repeated = *key;
  }
  return request;
}

}  // namespace kerf::net
