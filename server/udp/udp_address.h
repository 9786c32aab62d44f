// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <netinet/in.h>
#include <sys/socket.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace kerf::net {

/// The addresses of a datagram: the peer's, and the local address that the peer uses.
struct UdpAddress {
  sockaddr_storage peer{};
  socklen_t peer_bytes = 0;  ///< 0: unknown
  /// For a socket that listens on all addresses: an answer must come from the address to which the
  /// peer sends, or a NAT or the peer's system would drop it. The family decides which one is used.
  in_pktinfo own_v4{};
  in6_pktinfo own_v6{};
};

/// Parses a numeric IPv4 or IPv6 address.
std::optional<UdpAddress> to_address(const std::string& text, std::uint16_t port);
/// Returns the port that the socket is bound to, or 0 if it is not bound.
std::uint16_t port_of(int socket);
/// Makes the system report the local address to which each datagram was sent.
void request_local_address(int socket, int family);

/// Returns the number of bytes received, truncated to the size of `bytes`, or -1 with errno. Does
/// not block.
ssize_t receive_datagram(int socket, std::span<std::byte> bytes, UdpAddress& from);
/// Returns whether the system has accepted the datagram. Does not block.
bool send_datagram(int socket, std::span<const std::byte> bytes, const UdpAddress& to);

}  // namespace kerf::net
