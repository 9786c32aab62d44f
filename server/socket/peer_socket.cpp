// SPDX-License-Identifier: Apache-2.0
#include "server/socket/peer_socket.h"

#include <array>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <chrono>
#include <span>
#include <string>
#include <utility>

namespace kerf::net {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using boost::system::error_code;

namespace {

/// Larger frames close the connection with 1009 before they are read. Frames between the protocol's
/// limit and this one are answered with a typed error.
constexpr std::size_t kFrameReadMax = std::size_t{64} * 1024;
constexpr std::chrono::seconds kHandshakeTime{5};
/// Idle peers are pinged; one that does not answer within this time is dropped.
constexpr std::chrono::seconds kIdleTime{20};

}  // namespace

PeerSocket::PeerSocket(asio::ip::tcp::socket socket, std::string_view protocol)
    : socket_(std::move(socket)), protocol_(protocol), hello_timer_(socket_.get_executor()) {}

void PeerSocket::start(UpgradeRequest request) {
  auto run = [self = shared_from_this(), request = std::move(request)]() mutable {
    return self->run(std::move(request));
  };
  asio::co_spawn(socket_.get_executor(), std::move(run), asio::detached);
}

asio::awaitable<void> PeerSocket::act() { co_return; }

asio::awaitable<void> PeerSocket::run(UpgradeRequest request) {
  error_code error;
  configure();
  co_await socket_.async_accept(request, asio::redirect_error(asio::use_awaitable, error));
  if (!error) {
    open_ = true;
    limit_hello();
    pump();
  }
  while (!error && !failed_ && !conversation().broken()) {
    in_.consume(in_.size());
    co_await socket_.async_read(in_, asio::redirect_error(asio::use_awaitable, error));
    if (error) break;
    const auto data = in_.cdata();
    const std::span frame(static_cast<const std::byte*>(data.data()), data.size());
    conversation().receive(frame, socket_.got_text(), Clock::now());
    pump();
    conversation().refresh();
    pump();
    if (conversation().has_action()) co_await act();
  }
  hello_timer_.cancel();
  closed();
}

/// Options that agents and viewers share: no compression (a shared frame is encoded once for all),
/// keep-alive pings, no fragments, the sub-protocol in the response.
void PeerSocket::configure() {
  beast::get_lowest_layer(socket_).expires_never();  // the WebSocket has its own deadlines
  websocket::stream_base::timeout timeout{};
  timeout.handshake_timeout = kHandshakeTime;
  timeout.idle_timeout = kIdleTime;
  timeout.keep_alive_pings = true;
  socket_.set_option(timeout);
  socket_.set_option(websocket::stream_base::decorator(
      [name = std::string(protocol_)](websocket::response_type& response) {
        response.set(beast::http::field::sec_websocket_protocol, name);
        response.set(beast::http::field::server, "kerf");
      }));
  socket_.auto_fragment(false);
  socket_.read_message_max(kFrameReadMax);
}

void PeerSocket::limit_hello() {
  hello_timer_.expires_after(std::chrono::microseconds(std::int64_t(wire::kHelloTimeoutS * 1e6)));
  hello_timer_.async_wait([self = shared_from_this()](error_code error) {
    if (error) return;
    self->conversation().hello_expired();
    self->pump();
  });
}

void PeerSocket::pump() {
  if (!open_ || failed_) return;
  if (conversation().broken()) {
    beast::get_lowest_layer(socket_).close();
    return;
  }
  if (writing_) return;
  const bool leaves = conversation().take(out_);
  if (!leaves && !conversation().finishing()) return;
  writing_ = true;
  if (!leaves) {
    return socket_.async_close(websocket::close_code::going_away,
                               [self = shared_from_this()](error_code) {});
  }
  const std::array<asio::const_buffer, 2> parts = {
      asio::buffer(out_.bytes), out_.shared ? asio::buffer(*out_.shared) : asio::const_buffer()};
  socket_.text(out_.is_text());
  socket_.async_write(
      parts, [self = shared_from_this()](error_code error, std::size_t) { self->written(error); });
}

void PeerSocket::written(error_code error) {
  writing_ = false;
  if (error) {
    failed_ = true;
    return;
  }
  conversation().sent(out_);
  pump();
}

}  // namespace kerf::net
