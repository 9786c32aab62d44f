// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <expected>
#include <string>
#include <string_view>
#include <vector>

namespace kerf::net {

struct RequestHead;

/// The proxies whose word about their clients counts (--trust-proxy).
class TrustedProxies {
 public:
  /// Each text is an IP address, or one with the bits of its network: "10.0.0.0/8". The error is
  /// one sentence.
  static std::expected<TrustedProxies, std::string> parse(const std::vector<std::string>& texts);

  bool empty() const { return networks_.empty(); }
  /// Whether an IP address is one of them.
  bool contains(std::string_view address) const;

 private:
  using Bytes = std::array<std::uint8_t, 16>;  ///< IPv4 as ::ffff:a.b.c.d
  struct Network {
    Bytes bytes{};
    unsigned bits = 0;
  };
  std::vector<Network> networks_;
};

/// Returns the address of the client for whom proxies have extended `forwarded_for`
/// (X-Forwarded-For): the last one that is no trusted proxy; empty if there is none, or something
/// else stands there.
std::string client_of(std::string_view forwarded_for, const TrustedProxies& proxies);

/// Returns the network that limits of one client apply to: an IPv4 address, or the first 64 bits of
/// an IPv6 address, which one client has to itself. Any other text as it is.
std::string network_of(std::string_view address);

/// Replaces the address of the client, the host and whether it has come over TLS by what a trusted
/// proxy says; no effect for any other peer.
void apply_forwarding(RequestHead& head, const TrustedProxies& proxies);

}  // namespace kerf::net
