// SPDX-License-Identifier: Apache-2.0
#include "server/udp/udp_address.h"

#include <arpa/inet.h>

#include <array>
#include <cstring>

namespace kerf::net {
namespace {

constexpr std::size_t kControlBytes = CMSG_SPACE(sizeof(in6_pktinfo));

template <typename Info>
void put_control(msghdr& message, int level, int type, const Info& info) {
  message.msg_controllen = CMSG_SPACE(sizeof info);
  cmsghdr* control = CMSG_FIRSTHDR(&message);
  control->cmsg_level = level;
  control->cmsg_type = type;
  control->cmsg_len = CMSG_LEN(sizeof info);
  std::memcpy(CMSG_DATA(control), &info, sizeof info);
}

void read_control(msghdr& message, UdpAddress& from) {
  for (cmsghdr* control = CMSG_FIRSTHDR(&message); control != nullptr;
       control = CMSG_NXTHDR(&message, control)) {
    if (control->cmsg_level == IPPROTO_IP && control->cmsg_type == IP_PKTINFO) {
      std::memcpy(&from.own_v4, CMSG_DATA(control), sizeof from.own_v4);
      from.own_v4.ipi_ifindex = 0;  // let routing choose the interface
    } else if (control->cmsg_level == IPPROTO_IPV6 && control->cmsg_type == IPV6_PKTINFO) {
      std::memcpy(&from.own_v6, CMSG_DATA(control), sizeof from.own_v6);
      if (!IN6_IS_ADDR_LINKLOCAL(&from.own_v6.ipi6_addr)) from.own_v6.ipi6_ifindex = 0;
    }
  }
}

}  // namespace

std::optional<UdpAddress> to_address(const std::string& text, std::uint16_t port) {
  UdpAddress address;
  sockaddr_in four{};
  if (inet_pton(AF_INET, text.c_str(), &four.sin_addr) == 1) {
    four.sin_family = AF_INET;
    four.sin_port = htons(port);
    address.peer_bytes = sizeof four;
    std::memcpy(&address.peer, &four, sizeof four);
    return address;
  }
  sockaddr_in6 six{};
  if (inet_pton(AF_INET6, text.c_str(), &six.sin6_addr) != 1) return std::nullopt;
  six.sin6_family = AF_INET6;
  six.sin6_port = htons(port);
  address.peer_bytes = sizeof six;
  std::memcpy(&address.peer, &six, sizeof six);
  return address;
}

std::uint16_t port_of(int socket) {
  sockaddr_storage bound{};
  socklen_t bytes = sizeof bound;
  if (getsockname(socket, reinterpret_cast<sockaddr*>(&bound), &bytes) != 0) return 0;
  // The port has the same offset in both families.
  static_assert(offsetof(sockaddr_in, sin_port) == offsetof(sockaddr_in6, sin6_port));
  in_port_t port = 0;
  std::memcpy(&port, reinterpret_cast<const char*>(&bound) + offsetof(sockaddr_in, sin_port),
              sizeof port);
  return ntohs(port);
}

void request_local_address(int socket, int family) {
  const int on = 1;
  if (family == AF_INET) {
    ::setsockopt(socket, IPPROTO_IP, IP_PKTINFO, &on, sizeof on);
  } else {
    ::setsockopt(socket, IPPROTO_IPV6, IPV6_RECVPKTINFO, &on, sizeof on);
  }
}

ssize_t receive_datagram(int socket, std::span<std::byte> bytes, UdpAddress& from) {
  alignas(cmsghdr) std::array<char, kControlBytes> control{};
  iovec part{bytes.data(), bytes.size()};
  msghdr message{};
  message.msg_name = &from.peer;
  message.msg_namelen = sizeof from.peer;
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  message.msg_controllen = control.size();
  const ssize_t count = ::recvmsg(socket, &message, MSG_DONTWAIT);
  if (count < 0) return count;
  from.peer_bytes = message.msg_namelen;
  read_control(message, from);
  return count;
}

bool send_datagram(int socket, std::span<const std::byte> bytes, const UdpAddress& to) {
  alignas(cmsghdr) std::array<char, kControlBytes> control{};
  iovec part{const_cast<std::byte*>(bytes.data()), bytes.size()};
  msghdr message{};
  message.msg_name = const_cast<sockaddr_storage*>(&to.peer);
  message.msg_namelen = to.peer_bytes;
  message.msg_iov = &part;
  message.msg_iovlen = 1;
  message.msg_control = control.data();
  if (to.peer.ss_family == AF_INET) {
    put_control(message, IPPROTO_IP, IP_PKTINFO, to.own_v4);
  } else {
    put_control(message, IPPROTO_IPV6, IPV6_PKTINFO, to.own_v6);
  }
  return ::sendmsg(socket, &message, MSG_DONTWAIT | MSG_NOSIGNAL) >= 0;
}

}  // namespace kerf::net
