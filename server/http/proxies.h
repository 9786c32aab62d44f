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

/// The proxies that are trusted to name their clients (--trust-proxy).
class TrustedProxies {
 public:
  /// Parses texts that are IP addresses or networks: "10.0.0.0/8". The error is one sentence.
  static std::expected<TrustedProxies, std::string> parse(const std::vector<std::string>& texts);

  bool empty() const { return networks_.empty(); }
  /// Whether an IP address belongs to one of them.
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
/// (X-Forwarded-For): the last address that is no trusted proxy. Empty if there is none or it is
/// malformed.
std::string client_of(std::string_view forwarded_for, const TrustedProxies& proxies);

/// Returns the network to which limits per client apply: an IPv4 address, or the first 64 bits of
/// an IPv6 address, which usually belong to one client. Any other text is returned unchanged.
std::string network_of(std::string_view address);

/// Replaces the client's address, the host and the TLS flag by the values of a trusted proxy. No
/// effect for other peers.
void apply_forwarding(RequestHead& head, const TrustedProxies& proxies);

}  // namespace kerf::net
