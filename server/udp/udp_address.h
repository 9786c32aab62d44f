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

/// Both endpoints of a datagram: the peer's address and the local address that the peer uses.
struct UdpAddress {
  sockaddr_storage peer{};
  socklen_t peer_bytes = 0;  ///< 0: unknown
  /// Local address that received the peer's datagram, in the field of the peer's address family.
  /// A socket bound to all addresses must answer from this address; otherwise the peer's firewall
  /// or a NAT drops the answer.
  in_pktinfo own_v4{};
  in6_pktinfo own_v6{};
};

/// Parses a numeric IPv4 or IPv6 address; returns nullopt for anything else, e.g. a host name.
std::optional<UdpAddress> to_address(const std::string& text, std::uint16_t port);
/// Returns the local port of a bound socket; 0 if it is not bound.
std::uint16_t port_of(int socket);
/// Makes the kernel report the destination address of each received datagram (IP_PKTINFO,
/// IPV6_RECVPKTINFO).
void enable_packet_info(int socket, int family);

/// Receives one datagram without blocking. Returns its size (a longer datagram is truncated to
/// `bytes`), or -1 with errno set.
ssize_t receive_datagram(int socket, std::span<std::byte> bytes, UdpAddress& from);
/// Sends one datagram without blocking. Returns whether the kernel accepted it.
bool send_datagram(int socket, std::span<const std::byte> bytes, const UdpAddress& to);

}  // namespace kerf::net
