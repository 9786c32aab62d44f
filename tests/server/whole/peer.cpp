// SPDX-License-Identifier: Apache-2.0
#include "tests/server/whole/peer.h"

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>

#include "tests/support/eventually.h"

namespace kerf::test {
namespace {

/// Only a failed test reaches this limit.
constexpr timeval kLimit{.tv_sec = 30 * kPatience, .tv_usec = 0};

sockaddr_in address_of(const std::string& text, std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  inet_pton(AF_INET, text.c_str(), &address.sin_addr);
  return address;
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(), [](unsigned char c) { return std::tolower(c); });
  return result;
}

std::string big_endian(std::uint64_t value, int bytes) {
  std::string text;
  for (int n = bytes - 1; n >= 0; --n) text.push_back(static_cast<char>(value >> (8 * n) & 0xFF));
  return text;
}

}  // namespace

Peer::Peer(std::uint16_t port, const std::string& from)
    : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  const sockaddr_in own = address_of(from, 0), server = address_of("127.0.0.1", port);
  const int on = 1;
  setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &kLimit, sizeof kLimit);
  setsockopt(socket_, SOL_SOCKET, SO_SNDTIMEO, &kLimit, sizeof kLimit);
  if (bind(socket_, reinterpret_cast<const sockaddr*>(&own), sizeof own) != 0 ||
      connect(socket_, reinterpret_cast<const sockaddr*>(&server), sizeof server) != 0) {
    throw std::runtime_error("cannot connect to port " + std::to_string(port));
  }
}

Peer::~Peer() {
  if (socket_ >= 0) close(socket_);
}

bool Peer::send(std::string_view bytes) const {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

void Peer::end_sending() const { shutdown(socket_, SHUT_WR); }

bool Peer::receive(std::string& bytes) const {
  std::array<char, 65536> part{};
  const ssize_t size = recv(socket_, part.data(), part.size(), 0);
  if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
    throw std::runtime_error("nothing comes from the server, nor an end");
  }
  if (size <= 0) return false;
  bytes.append(part.data(), static_cast<std::size_t>(size));
  return true;
}

std::string Peer::rest() const {
  std::string bytes;
  while (receive(bytes)) continue;
  return bytes;
}

bool Peer::has_input() const {
  pollfd wanted{socket_, POLLIN, 0};
  return poll(&wanted, 1, 0) > 0;
}

void Peer::reset() {
  const linger at_once{.l_onoff = 1, .l_linger = 0};
  setsockopt(socket_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  close(std::exchange(socket_, -1));
}

std::string Answer::header(std::string_view name) const {
  const std::string wanted = "\r\n" + lower(name) + ": ";
  const auto at = lower(head).find(wanted);
  if (at == head.npos) return {};
  const auto begin = at + wanted.size();
  return head.substr(begin, head.find("\r\n", begin) - begin);
}

Answer read_answer(const std::string& bytes) {
  const auto end = bytes.find("\r\n\r\n");
  if (!bytes.starts_with("HTTP/1.") || end == bytes.npos) return {};
  return {.status = static_cast<unsigned>(std::stoul(bytes.substr(9, 3))),
          .head = bytes.substr(0, end + 2),
          .body = bytes.substr(end + 4)};
}

Answer ask(std::uint16_t port, const std::string& method, const std::string& target,
           const std::string& body, const Headers& headers) {
  std::string request = method + " " + target + " HTTP/1.1\r\nConnection: close\r\n";
  bool has_host = false, has_length = false;
  for (const auto& [name, value] : headers) {
    has_host = has_host || name == "Host";
    has_length = has_length || name == "Content-Length";
    request += name + ": " + value + "\r\n";
  }
  if (!has_host) request += "Host: 127.0.0.1:" + std::to_string(port) + "\r\n";
  if (!has_length) request += "Content-Length: " + std::to_string(body.size()) + "\r\n";
  const Peer peer(port);
  peer.send(request + "\r\n" + body);
  return read_answer(peer.rest());
}

Headers bearer(const std::string& token) { return {{"Authorization", "Bearer " + token}}; }

std::string bytes_of(const Frame& frame) {
  const std::size_t size = frame.payload.size();
  std::string length = size < 126     ? big_endian(size, 1)
                       : size < 65536 ? "\x7E" + big_endian(size, 2)
                                      : "\x7F" + big_endian(size, 8);
  length = frame.length.value_or(length);
  if (frame.is_masked) length.front() = static_cast<char>(length.front() | 0x80);
  const std::string mask = frame.is_masked ? std::string(4, '\0') : "";
  return static_cast<char>(frame.first) + length + mask + frame.payload;
}

WebPeer::WebPeer(std::uint16_t port, const std::string& target, const std::string& protocol,
                 const Headers& headers)
    : peer_(port) {
  std::string request = "GET " + target +
                        " HTTP/1.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                        "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
                        "Sec-WebSocket-Version: 13\r\n";
  bool has_host = false;
  for (const auto& [name, value] : headers) {
    has_host = has_host || name == "Host";
    request += name + ": " + value + "\r\n";
  }
  if (!has_host) request += "Host: 127.0.0.1:" + std::to_string(port) + "\r\n";
  if (!protocol.empty()) request += "Sec-WebSocket-Protocol: " + protocol + "\r\n";
  peer_.send(request + "\r\n");
  while (!buffer_.contains("\r\n\r\n") && peer_.receive(buffer_)) continue;
  upgrade_ = read_answer(buffer_);
  buffer_ = std::exchange(upgrade_.body, {});
  if (upgrade_.status == 101) return;
  while (peer_.receive(buffer_)) continue;
  upgrade_.body = std::exchange(buffer_, {});
}

bool WebPeer::has(std::size_t count) {
  while (buffer_.size() < count) {
    if (!peer_.receive(buffer_)) return false;
  }
  return true;
}

std::optional<WebPeer::Message> WebPeer::receive() {
  for (;;) {
    if (!has(2)) return std::nullopt;
    const auto at = [this](std::size_t n) { return static_cast<unsigned char>(buffer_[n]); };
    const int opcode = at(0) & 0x0F;
    std::size_t size = at(1) & 0x7FU;
    const std::size_t head = size < 126 ? 2 : size == 126 ? 4 : 10;
    if (!has(head)) return std::nullopt;
    if (head > 2) size = 0;
    for (std::size_t n = 2; n < head; ++n) size = size << 8 | at(n);
    if (!has(head + size)) return std::nullopt;
    std::string payload = buffer_.substr(head, size);
    buffer_.erase(0, head + size);
    if (opcode == 8) {
      if (size >= 2) {
        close_code_ =
            static_cast<unsigned char>(payload[0]) * 256U + static_cast<unsigned char>(payload[1]);
      }
      return std::nullopt;
    }
    if (opcode == 9) peer_.send(bytes_of({.first = 0x8A, .payload = payload}));
    if (opcode == 1) text_bytes_ += size;
    if (opcode == 1 || opcode == 2) return Message{opcode == 1, std::move(payload)};
  }
}

Json WebPeer::receive(const std::string& type) {
  while (const auto message = receive()) {
    if (!message->is_text) continue;
    Json json = Json::parse(message->bytes);
    if (json.at("type") == type) return json;
  }
  throw std::runtime_error("closed with " + std::to_string(close_code_) + " before " + type);
}

unsigned WebPeer::closed() {
  while (receive()) continue;
  return close_code_;
}

}  // namespace kerf::test
