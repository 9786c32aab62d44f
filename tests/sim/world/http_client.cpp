// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/world/http_client.h"

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <optional>
#include <string_view>

namespace kerf::sim {
namespace {

/// A socket that is closed at its end.
struct Socket {
  int file = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  ~Socket() { close(file); }
};

bool connects(int file, int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  return connect(file, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

/// Waits until the socket is ready; false: the time is over.
bool awaits(int file, short events, Time end) {
  pollfd wanted{file, events, 0};
  const Time left = end - now();
  return left > 0 && poll(&wanted, 1, static_cast<int>(left / kMillisecond) + 1) > 0;
}

bool sends(int file, std::string_view text, Time end) {
  while (!text.empty()) {
    const ssize_t sent = send(file, text.data(), text.size(), MSG_NOSIGNAL);
    if (sent > 0) {
      text.remove_prefix(static_cast<std::size_t>(sent));
    } else if (!awaits(file, POLLOUT, end)) {
      return false;
    } else if (sent < 0 && errno != EAGAIN) {
      return false;
    }
  }
  return true;
}

std::string field(std::string_view head, std::string_view name) {
  std::string lower(head);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  const std::size_t at = lower.find("\r\n" + std::string(name) + ": ");
  if (at == std::string::npos) return {};
  const std::size_t begin = at + name.size() + 4;
  return std::string(head.substr(begin, head.find("\r\n", begin) - begin));
}

template <typename Number>
Number number(std::string_view text) {
  Number value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// The answer, if all of it has come.
std::optional<HttpAnswer> whole(const std::string& text, bool is_head) {
  const std::size_t end = text.find("\r\n\r\n");
  if (end == std::string::npos) return std::nullopt;
  const std::string_view head = std::string_view(text).substr(0, end + 2);
  const auto length = number<std::size_t>(field(head, "content-length"));
  if (!is_head && text.size() < end + 4 + length) return std::nullopt;
  const std::string cookie = field(head, "set-cookie");
  return HttpAnswer{.status = number<int>(head.substr(std::min<std::size_t>(9, head.size()), 3)),
                    .body = text.substr(end + 4),
                    .location = field(head, "location"),
                    .cookie = cookie.substr(0, cookie.find(';'))};
}

}  // namespace

HttpAnswer ask(int port, const std::string& method, const std::string& target,
               const std::string& body, Time patience, const std::string& fields) {
  const Time end = now() + patience;
  const Socket connection;
  if (connection.file < 0 || !connects(connection.file, port)) return {};
  const std::string request = method + " " + target +
                              " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) +
                              "\r\nConnection: close\r\n" + fields +
                              "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
  if (!sends(connection.file, request, end)) return {};
  std::string text;
  std::array<char, 65536> part{};
  for (;;) {
    const ssize_t size = recv(connection.file, part.data(), part.size(), 0);
    if (size > 0) {
      text.append(part.data(), static_cast<std::size_t>(size));
      if (auto answer = whole(text, method == "HEAD")) return *std::move(answer);
    } else if (size == 0 || (errno != EAGAIN && errno != EINTR)) {
      return {};
    } else if (!awaits(connection.file, POLLIN, end)) {
      return {};
    }
  }
}

}  // namespace kerf::sim
