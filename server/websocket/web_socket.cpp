// SPDX-License-Identifier: Apache-2.0
#include "server/websocket/web_socket.h"

#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <boost/beast/websocket/teardown.hpp>
#include <utility>

#include "server/websocket/upgrade_request.h"

namespace kerf::net {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using boost::system::error_code;

/// For Beast: ends the connection below a closed WebSocket.
template <class Handler>
void async_teardown(beast::role_type role, ByteStream& stream, Handler&& handler) {
  stream.flush();  // the close frame may be held after a message that nothing follows
  if (stream.tls() != nullptr && stream.socket().is_open()) stream.tls()->say_end();
  websocket::async_teardown(role, stream.socket(), std::forward<Handler>(handler));
}

namespace {

beast::string_view view(std::string_view text) { return {text.data(), text.size()}; }

}  // namespace

struct WebSocket::State {
  State(ByteStream below, const WebSocketLimits& times) : stream(std::move(below)), limits(times) {}
  /// Whether silence of the peer ends the connection. Takes effect at the next read, or at once.
  void limit_silence(bool on) {
    stream.set_option(websocket::stream_base::timeout{
        .handshake_timeout = limits.handshake,
        .idle_timeout = on ? limits.idle : websocket::stream_base::none(),
        .keep_alive_pings = true});
  }
  websocket::stream<ByteStream, false> stream;
  WebSocketLimits limits;
  beast::flat_buffer in;
};

WebSocket::WebSocket(ByteStream stream, const WebSocketLimits& limits)
    : state_(std::make_unique<State>(std::move(stream), limits)) {
  state_->limit_silence(false);
  state_->stream.auto_fragment(false);
  state_->stream.read_message_max(limits.message_bytes);
}

WebSocket::~WebSocket() = default;

asio::any_io_executor WebSocket::executor() const { return state_->stream.get_executor(); }

asio::ip::tcp::socket& WebSocket::tcp() { return state_->stream.next_layer().socket(); }

asio::awaitable<error_code> WebSocket::accept(const UpgradeRequest& request,
                                              std::string_view protocol) {
  state_->stream.set_option(websocket::stream_base::decorator(
      [name = std::string(protocol)](websocket::response_type& response) {
        response.set(http::field::sec_websocket_protocol, name);
        response.set(http::field::server, "kerf");
      }));
  error_code error;
  co_await state_->stream.async_accept(request.message,
                                       asio::redirect_error(asio::use_awaitable, error));
  co_return error;
}

asio::awaitable<HandshakeAnswer> WebSocket::shake_hands(std::string_view host,
                                                        std::string_view target,
                                                        std::string_view protocol,
                                                        std::string_view token) {
  state_->stream.set_option(
      websocket::stream_base::decorator([name = std::string(protocol), secret = std::string(token)](
                                            websocket::request_type& request) {
        request.set(http::field::sec_websocket_protocol, name);
        if (!secret.empty()) request.set(http::field::authorization, "Bearer " + secret);
      }));
  HandshakeAnswer answer;
  websocket::response_type response;
  co_await state_->stream.async_handshake(response, view(host), view(target),
                                          asio::redirect_error(asio::use_awaitable, answer.error));
  if (answer.error == websocket::error::upgrade_declined) {
    answer.declined_status = response.result_int();
    answer.declined_body = response.body();
  }
  answer.protocol = std::string(response[http::field::sec_websocket_protocol]);
  co_return answer;
}

asio::awaitable<error_code> WebSocket::read() {
  error_code error;
  state_->in.clear();
  // While a long batch is being cut, nothing is read, pongs included.
  state_->limit_silence(true);
  co_await state_->stream.async_read(state_->in, asio::redirect_error(asio::use_awaitable, error));
  state_->limit_silence(false);
  co_return error;
}

std::span<const std::byte> WebSocket::message() const {
  const auto data = state_->in.cdata();
  return {static_cast<const std::byte*>(data.data()), data.size()};
}

std::string_view WebSocket::text() const {
  const auto data = state_->in.cdata();
  return {static_cast<const char*>(data.data()), data.size()};
}

bool WebSocket::is_text() const { return state_->stream.got_text(); }

void WebSocket::hold(bool on) { state_->stream.next_layer().hold(on); }

void WebSocket::flush() { state_->stream.next_layer().flush(); }

void WebSocket::write(bool text, std::array<asio::const_buffer, 2> parts, Written written) {
  state_->stream.text(text);
  state_->stream.async_write(parts, [written = std::move(written)](
                                        error_code error, std::size_t) mutable { written(error); });
}

asio::awaitable<error_code> WebSocket::write(bool text, asio::const_buffer bytes) {
  error_code error;
  auto start = [&](auto handler) {
    write(
        text, {bytes, asio::const_buffer()},
        [handler = std::move(handler)](error_code result) mutable { std::move(handler)(result); });
  };
  auto token = asio::redirect_error(asio::use_awaitable, error);
  co_await asio::async_initiate<decltype(token), void(error_code)>(std::move(start), token);
  co_return error;
}

asio::awaitable<error_code> WebSocket::close(std::uint16_t code) {
  error_code error;
  co_await state_->stream.async_close(code, asio::redirect_error(asio::use_awaitable, error));
  co_return error;
}

void WebSocket::cut() { state_->stream.next_layer().close(); }

}  // namespace kerf::net
