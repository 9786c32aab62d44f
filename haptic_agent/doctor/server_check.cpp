// SPDX-License-Identifier: Apache-2.0
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <system_error>
#include <vector>

#include "haptic_agent/device/text_fields.h"
#include "haptic_agent/doctor/checks.h"
#include "haptic_agent/realtime/clock.h"
#include "server/tls/tls_channel.h"

namespace kerf::agent {
namespace {

constexpr int kTimeoutMs = 3000;
constexpr int kConnections = 9;
constexpr std::size_t kAnswerBytes = 256;
/// Round trip beyond which a user feels the delay of the server's force.
constexpr std::uint64_t kPromptUs = 25'000;

class Socket {
 public:
  explicit Socket(int fd) : fd_(fd) {}
  ~Socket() {
    if (fd_ >= 0) close(fd_);
  }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  int fd() const { return fd_; }

 private:
  int fd_;
};

using Addresses = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

bool ready(int fd, short events) {
  pollfd waited{.fd = fd, .events = events, .revents = 0};
  return poll(&waited, 1, kTimeoutMs) == 1;
}

/// Returns the error. Empty if connected.
std::string connect_to(const addrinfo& address, int fd) {
  if (connect(fd, address.ai_addr, address.ai_addrlen) == 0) return {};
  if (errno != EINPROGRESS) return std::generic_category().message(errno);
  if (!ready(fd, POLLOUT)) return "no answer";
  int error = 0;
  socklen_t size = sizeof error;
  getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size);
  return error == 0 ? std::string() : std::generic_category().message(error);
}

/// Repeats a TLS step until it has ended, or no data arrives.
template <class Attempt>
net::TlsStep complete(int fd, const Attempt& attempt) {
  while (true) {
    const net::TlsStep step = attempt();
    const bool reads = step == net::TlsStep::kWantsRead;
    if (!reads && step != net::TlsStep::kWantsWrite) return step;
    if (!ready(fd, reads ? POLLIN : POLLOUT)) return net::TlsStep::kFailed;
  }
}

/// Returns the response to a request, or the TLS fault. Empty without a response.
std::string ask_over_tls(int fd, const ServerUrl& server, const std::string& authorities,
                         const std::string& request) {
  const auto context = net::TlsContext::of_client(authorities);
  if (!context) return context.error();
  net::TlsChannel channel(*context, fd, server.host);
  if (complete(fd, [&] { return channel.handshake(); }) != net::TlsStep::kDone) {
    return channel.failure();
  }
  std::size_t count = 0;
  std::array<char, kAnswerBytes> answer{};
  const auto sent = std::as_bytes(std::span(request));
  const auto got = std::as_writable_bytes(std::span(answer));
  if (complete(fd, [&] { return channel.write(sent, count); }) != net::TlsStep::kDone ||
      complete(fd, [&] { return channel.read(got, count); }) != net::TlsStep::kDone) {
    return channel.failure();
  }
  return {answer.data(), count};
}

std::string ask(int fd, const std::string& request) {
  if (send(fd, request.data(), request.size(), MSG_NOSIGNAL) < 0 || !ready(fd, POLLIN)) return {};
  std::array<char, kAnswerBytes> answer{};
  const auto got = recv(fd, answer.data(), answer.size(), 0);
  return got <= 0 ? std::string() : std::string(answer.data(), static_cast<std::size_t>(got));
}

/// Returns the status line of the response to GET /healthz, or the fault.
std::string request_health(int fd, const ServerUrl& server, const std::string& authorities) {
  const std::string request = join(
      {"GET /healthz HTTP/1.1\r\nHost: ", server.authority(), "\r\nConnection: close\r\n\r\n"});
  const std::string text =
      server.tls ? ask_over_tls(fd, server, authorities, request) : ask(fd, request);
  return text.substr(0, text.find('\r'));
}

Finding unreachable(const ServerUrl& server, const std::string& reason) {
  return {
      .health = Health::kBad,
      .what = join({"the server ", server.host, ":", server.port, " cannot be reached: ", reason}),
      .advice = {
          "check that kerf-server is running there and that no firewall blocks this machine"}};
}

}  // namespace

Finding check_server(const ServerUrl& server, const std::string& authorities) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int code = getaddrinfo(server.host.c_str(), server.port.c_str(), &hints, &found);
      code != 0) {
    return unreachable(server, gai_strerror(code));
  }
  const Addresses addresses(found, freeaddrinfo);
  std::vector<std::uint64_t> times_us;
  std::string health;
  for (int i = 0; i < kConnections; ++i) {
    std::string reason = "no address";
    for (const addrinfo* at = addresses.get(); at != nullptr; at = at->ai_next) {
      const Socket socket(
          ::socket(at->ai_family, at->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, at->ai_protocol));
      const std::uint64_t start_us = monotonic_us();
      reason = connect_to(*at, socket.fd());
      if (!reason.empty()) continue;
      times_us.push_back(monotonic_us() - start_us);
      if (i == 0) health = request_health(socket.fd(), server, authorities);
      break;
    }
    if (!reason.empty()) return unreachable(server, reason);
  }
  if (!health.starts_with("HTTP/") || health.find(" 200") == std::string::npos) {
    return {.health = Health::kBad,
            .what = join({"no healthy kerf-server at ", server.host, ":", server.port, " (",
                          health.empty() ? "no response" : health, ")"})};
  }
  std::ranges::sort(times_us);
  const std::uint64_t middle_us = times_us[times_us.size() / 2];
  Finding finding{.what = join({"the server ", server.host, ":", server.port,
                                " is healthy; round trip ", std::to_string(middle_us),
                                " us, at most ", std::to_string(times_us.back()), " us"})};
  if (middle_us > kPromptUs) {
    finding.health = Health::kWarning;
    finding.advice = {"above 25 ms users feel the delay; use a server with a shorter round trip"};
  }
  return finding;
}

}  // namespace kerf::agent
