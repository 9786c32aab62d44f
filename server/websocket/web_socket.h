// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "server/websocket/byte_stream.h"

namespace kerf::net {

struct UpgradeRequest;

/// Deadlines of a WebSocket, and the size of its messages.
struct WebSocketLimits {
  std::chrono::milliseconds handshake;  ///< for the opening and for the closing handshake
  /// A peer that is silent for half of this time is pinged. After all of it, reading fails. It
  /// counts from the start of a read, so an owner that does not read for long loses no peer.
  std::chrono::milliseconds idle;
  std::size_t message_bytes;  ///< a longer one ends the connection with close code 1009
};

/// The server's answer to a request for a WebSocket.
struct HandshakeAnswer {
  boost::system::error_code error;  ///< set if there is no WebSocket
  /// HTTP status and body of a server that has declined; 0 and empty otherwise.
  unsigned declined_status = 0;
  std::string declined_body;
  std::string protocol;  ///< sub-protocol that the server has chosen; empty if none
};

/// One WebSocket (RFC 6455) over a connected TCP socket, with TLS or without, of a client or a
/// server: binary and text messages, each in one frame, without compression. At most one read and
/// one write may be in progress. Everything runs on the executor of the TCP socket. The WebSocket
/// must outlive its operations. Beast's WebSocket is included in web_socket.cpp alone, which takes
/// 16 s to compile.
class WebSocket {
 public:
  /// Called once at the end of a write, on the executor.
  using Written = std::move_only_function<void(boost::system::error_code)>;
  template <class T>
  using Awaitable = boost::asio::awaitable<T>;

  WebSocket(ByteStream stream, const WebSocketLimits& limits);
  WebSocket(boost::asio::ip::tcp::socket socket, const WebSocketLimits& limits)
      : WebSocket(ByteStream(std::move(socket)), limits) {}
  ~WebSocket();
  WebSocket(const WebSocket&) = delete;
  WebSocket& operator=(const WebSocket&) = delete;

  boost::asio::any_io_executor executor() const;
  /// The underlying socket, for its options and addresses.
  boost::asio::ip::tcp::socket& tcp();

  /// Accepts `request`, which must remain valid until then, as a server that speaks `protocol`.
  Awaitable<boost::system::error_code> accept(const UpgradeRequest& request,
                                              std::string_view protocol);
  /// Requests a WebSocket of `host` (name and port) at `target` with the sub-protocol `protocol`,
  /// and `token` in an Authorization header unless it is empty.
  Awaitable<HandshakeAnswer> shake_hands(std::string_view host, std::string_view target,
                                         std::string_view protocol, std::string_view token = {});
  /// Waits for the next message. The functions below describe it until the next read.
  Awaitable<boost::system::error_code> read();
  std::span<const std::byte> message() const;
  std::string_view text() const;
  bool is_text() const;
  /// Messages from now on are held until one follows for which hold is off, or a packet is full.
  /// Then they leave together, which costs about as much as one. Without TLS only. Call flush() if
  /// none follows.
  void hold(bool on);
  void flush();
  /// Sends the parts as one message. Their bytes must remain valid until `written` is called.
  void write(bool text, std::array<boost::asio::const_buffer, 2> parts, Written written);
  /// The same for a coroutine.
  Awaitable<boost::system::error_code> write(bool text, boost::asio::const_buffer bytes);
  /// Sends a close frame with `code` (RFC 6455, 7.4.1) and waits for the peer's.
  Awaitable<boost::system::error_code> close(std::uint16_t code);
  /// Closes the TCP socket. Operations in progress end with an error.
  void cut();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kerf::net
