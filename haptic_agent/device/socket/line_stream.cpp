// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/device/socket/line_stream.h"

#include <netdb.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <system_error>

#include "haptic_agent/device/text_fields.h"

namespace kerf::agent {
namespace {

constexpr int kConnectMs = 1000;
/// Size of the kernel's send buffer: a peer that does not read is noticed after about ten lines.
constexpr int kSendBytes = 4096;

std::string error_text(int error) { return std::generic_category().message(error); }

/// Starts to connect a new socket. Returns it, or the negative error.
int start_connecting(int family, const sockaddr* address, socklen_t bytes) noexcept {
  const int fd = ::socket(family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd < 0) return -errno;
  ::setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &kSendBytes, sizeof kSendBytes);
  if (::connect(fd, address, bytes) == 0 || errno == EINPROGRESS) return fd;
  const int error = errno;
  ::close(fd);
  return -error;
}

/// Waits until a socket is connected. Returns 0 or the error.
int finish_connecting(int fd) noexcept {
  pollfd waited{.fd = fd, .events = POLLOUT, .revents = 0};
  if (::poll(&waited, 1, kConnectMs) != 1) return ETIMEDOUT;
  int error = 0;
  socklen_t size = sizeof error;
  ::getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size);
  return error;
}

int connect_path(const std::string& path) noexcept {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return -ENAMETOOLONG;
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  return start_connecting(AF_UNIX, reinterpret_cast<const sockaddr*>(&address), sizeof address);
}

std::expected<int, std::string> connect_host(const SocketAddress& where) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int code = ::getaddrinfo(where.host.c_str(), where.port.c_str(), &hints, &found)) {
    return std::unexpected(::gai_strerror(code));
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> addresses(found, ::freeaddrinfo);
  int fd = -EADDRNOTAVAIL;
  for (const addrinfo* at = found; at != nullptr && fd < 0; at = at->ai_next) {
    fd = start_connecting(at->ai_family, at->ai_addr, at->ai_addrlen);
    if (fd < 0) continue;
    if (const int error = finish_connecting(fd); error != 0) {
      ::close(fd);
      fd = -error;
    }
  }
  if (fd < 0) return std::unexpected(error_text(-fd));
  const int on = 1;
  ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  return fd;
}

}  // namespace

std::expected<SocketAddress, std::string> parse_socket_address(std::string_view text) {
  if (text.find('/') != text.npos) return SocketAddress{.path = std::string(text)};
  const std::size_t colon = text.rfind(':');
  const auto port = colon == text.npos ? std::nullopt : to_number(text.substr(colon + 1));
  constexpr double kMostPort = 65535;
  if (!port || !(*port >= 1 && *port <= kMostPort) || *port != static_cast<int>(*port) ||
      colon == 0) {
    return std::unexpected(
        join({"socket needs an address: socket:/PATH or socket:HOST:PORT, not '", text, "'"}));
  }
  return SocketAddress{.host = std::string(text.substr(0, colon)),
                       .port = std::string(text.substr(colon + 1))};
}

std::string to_string(const SocketAddress& address) {
  return address.path.empty() ? address.host + ":" + address.port : address.path;
}

std::expected<void, std::string> LineStream::connect(const SocketAddress& address) {
  close();
  if (!address.path.empty()) {
    fd_ = connect_path(address.path);
    if (fd_ >= 0) return {};
    const int error = -fd_;
    fd_ = -1;
    return std::unexpected(error_text(error));
  }
  const auto fd = connect_host(address);
  if (!fd) return std::unexpected(fd.error());
  fd_ = *fd;
  return {};
}

void LineStream::close() noexcept {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
  in_.clear();
  out_.clear();
}

bool LineStream::receive(std::size_t most) {
  std::array<char, 4096> bytes;
  for (;;) {
    const ssize_t got = ::recv(fd_, bytes.data(), bytes.size(), 0);
    if (got < 0) return errno == EAGAIN || errno == EINTR;
    if (got == 0) return false;
    in_.append(bytes.data(), static_cast<std::size_t>(got));
    const std::size_t begun = in_.rfind('\n');
    const std::size_t line = in_.size() - (begun == in_.npos ? 0 : begun + 1);
    if (line > most || in_.size() > 64 * most) return false;
    if (static_cast<std::size_t>(got) < bytes.size()) return true;
  }
}

bool LineStream::next(std::string& line) {
  const std::size_t end = in_.find('\n');
  if (end == in_.npos) return false;
  line.assign(in_, 0, end);
  if (line.ends_with('\r')) line.pop_back();
  in_.erase(0, end + 1);
  return true;
}

bool LineStream::queue(std::string_view text) {
  if (waiting()) return false;
  out_ = text;
  return true;
}

bool LineStream::flush() {
  while (!out_.empty()) {
    const ssize_t sent = ::send(fd_, out_.data(), out_.size(), MSG_NOSIGNAL);
    if (sent < 0) return errno == EAGAIN || errno == EINTR;
    out_.erase(0, static_cast<std::size_t>(sent));
  }
  return true;
}

}  // namespace kerf::agent
