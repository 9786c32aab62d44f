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

/// The two ends of a datagram's way: the peer, and which of this machine's addresses it knows.
struct UdpAddress {
  sockaddr_storage peer{};
  socklen_t peer_bytes = 0;  ///< 0: not known
  /// Of a socket that listens on all addresses: the answer has to come from the one that was asked,
  /// or else the peer's system, or a NAT, would not let it in. One of the two, by the family.
  in_pktinfo own_v4{};
  in6_pktinfo own_v6{};
};

/// A numeric IPv4 or IPv6 address.
std::optional<UdpAddress> to_address(const std::string& text, std::uint16_t port);
/// The port that a socket is bound to; 0 if none.
std::uint16_t port_of(int socket);
/// Has the system tell, of each datagram, to which address it was sent.
void ask_for_own_address(int socket, int family);

/// Both never wait. Bytes received (more than fit are cut off), or -1 with errno.
ssize_t receive_datagram(int socket, std::span<std::byte> bytes, UdpAddress& from);
/// True if the system has taken it.
bool send_datagram(int socket, std::span<const std::byte> bytes, const UdpAddress& to);

}  // namespace kerf::net
