// SPDX-License-Identifier: Apache-2.0
#include "server/http/proxies.h"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <optional>

#include "server/http/request_head.h"

namespace kerf::net {
namespace {

using Bytes = std::array<std::uint8_t, 16>;

constexpr unsigned kAllBits = 128, kV4Bits = 32, kClientBits = 64;
constexpr std::size_t kV4At = 12;

std::string_view trim(std::string_view text) {
  constexpr std::string_view kBlanks = " \t";
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

bool is_v4(const Bytes& bytes) {
  constexpr Bytes kMapped = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};
  return std::equal(kMapped.begin(), kMapped.begin() + kV4At, bytes.begin());
}

std::optional<Bytes> parse_address(std::string_view text) {
  const std::string name(text);
  Bytes bytes{};
  if (inet_pton(AF_INET6, name.c_str(), bytes.data()) == 1) return bytes;
  if (inet_pton(AF_INET, name.c_str(), bytes.data() + kV4At) != 1) return std::nullopt;
  bytes[kV4At - 2] = bytes[kV4At - 1] = 0xff;
  return bytes;
}

std::string to_text(const Bytes& bytes) {
  std::array<char, INET6_ADDRSTRLEN> text{};
  const bool v4 = is_v4(bytes);
  const void* from = v4 ? bytes.data() + kV4At : bytes.data();
  inet_ntop(v4 ? AF_INET : AF_INET6, from, text.data(), text.size());
  return text.data();
}

/// Removes the port and the IPv6 brackets that some proxies add.
std::string_view without_port(std::string_view text) {
  if (text.starts_with('[')) return text.substr(1, std::min(text.find(']'), text.size()) - 1);
  const bool has_port = std::ranges::count(text, ':') == 1;
  return has_port ? text.substr(0, text.find(':')) : text;
}

/// Returns the last value of a list: the one that the nearest proxy has added.
std::string_view last_of(std::string_view list) {
  const auto comma = list.rfind(',');
  return trim(comma == list.npos ? list : list.substr(comma + 1));
}

}  // namespace

std::expected<TrustedProxies, std::string> TrustedProxies::parse(
    const std::vector<std::string>& texts) {
  TrustedProxies proxies;
  for (const std::string& text : texts) {
    const auto slash = text.find('/');
    const auto address = parse_address(text.substr(0, slash));
    const bool v4 = address && text.find(':') == text.npos;
    unsigned bits = v4 ? kV4Bits : kAllBits;
    bool is_good = address.has_value();
    if (is_good && slash != text.npos) {
      const unsigned most = bits;
      const char* end = text.data() + text.size();
      const auto parsed = std::from_chars(text.data() + slash + 1, end, bits);
      is_good = parsed.ec == std::errc() && parsed.ptr == end && bits <= most;
    }
    if (!is_good) {
      return std::unexpected(text +
                             " is not an IP address, or one with the bits of its network, "
                             "e.g. 10.0.0.0/8");
    }
    proxies.networks_.push_back({*address, v4 ? kAllBits - kV4Bits + bits : bits});
  }
  return proxies;
}

bool TrustedProxies::contains(std::string_view address) const {
  const auto bytes = parse_address(address);
  if (!bytes) return false;
  return std::ranges::any_of(networks_, [&](const Network& network) {
    for (unsigned bit = 0; bit < network.bits; ++bit) {
      const auto differing = static_cast<unsigned>((*bytes)[bit / 8] ^ network.bytes[bit / 8]);
      if ((differing >> (7 - bit % 8) & 1U) != 0) return false;
    }
    return true;
  });
}

std::string client_of(std::string_view forwarded_for, const TrustedProxies& proxies) {
  while (!forwarded_for.empty()) {
    const std::string_view address = without_port(last_of(forwarded_for));
    if (!parse_address(address)) return {};
    if (!proxies.contains(address)) return std::string(address);
    const auto comma = forwarded_for.rfind(',');
    forwarded_for = forwarded_for.substr(0, comma == forwarded_for.npos ? 0 : comma);
  }
  return {};
}

std::string network_of(std::string_view address) {
  auto bytes = parse_address(address);
  if (!bytes) return std::string(address);
  if (!is_v4(*bytes)) std::fill(bytes->begin() + kClientBits / 8, bytes->end(), 0);
  return to_text(*bytes);
}

void apply_forwarding(RequestHead& head, const TrustedProxies& proxies) {
  if (!proxies.contains(head.address)) return;
  if (std::string client = client_of(head.forwarded_for, proxies); !client.empty()) {
    head.address = std::move(client);
  }
  if (!head.forwarded_host.empty()) head.host = last_of(head.forwarded_host);
  if (!head.forwarded_proto.empty()) head.is_secure = last_of(head.forwarded_proto) == "https";
}

}  // namespace kerf::net
