// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <expected>
#include <string>
#include <string_view>

namespace kerf::agent {

/// Address of a device's process: the path of a Unix socket, or a host and a port.
struct SocketAddress {
  std::string path{};
  std::string host{};
  std::string port{};

  bool operator==(const SocketAddress&) const = default;
};

/// Parses PATH, which contains a slash, or HOST:PORT. The error is one sentence.
std::expected<SocketAddress, std::string> parse_socket_address(std::string_view text);
std::string to_string(const SocketAddress& address);

/// A connected socket that carries lines. Does not block. Used by one thread.
class LineStream {
 public:
  LineStream() = default;
  ~LineStream() { close(); }
  LineStream(const LineStream&) = delete;
  LineStream& operator=(const LineStream&) = delete;

  /// Connects, within a second. The error is one clause.
  std::expected<void, std::string> connect(const SocketAddress& address);
  void close() noexcept;
  int fd() const noexcept { return fd_; }

  /// Receives the pending bytes. Returns false if the connection is closed, or if a line is longer
  /// than `most` bytes.
  bool receive(std::size_t most);
  /// Fetches the next complete line without its newline. Returns false if there is none.
  bool next(std::string& line);
  /// Appends a text to the output. Returns false and appends nothing while earlier text is waiting.
  bool queue(std::string_view text);
  /// Sends the waiting output as far as the socket accepts it. Returns false if the connection is
  /// lost.
  bool flush();
  bool waiting() const noexcept { return !out_.empty(); }

 private:
  int fd_ = -1;
  std::string in_, out_;
};

}  // namespace kerf::agent
