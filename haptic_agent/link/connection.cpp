// SPDX-License-Identifier: Apache-2.0
// Establishes a connection, up to the welcome.
#include "haptic_agent/link/connection.h"

#include <boost/asio/ip/tcp.hpp>
#include <chrono>

#include "server/wire/control.h"

namespace kerf::agent {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;
using std::chrono::seconds;
using Socket = websocket::stream<beast::tcp_stream, false>;

constexpr seconds kConnectTimeout{3};
constexpr seconds kWelcomeTimeout{5};
/// A connection without any traffic for this long, WebSocket pings included, is lost.
constexpr seconds kIdleTimeout{6};

asio::awaitable<std::optional<Loss>> connect(Socket& socket, const ServerUrl& server) {
  tcp::resolver resolver(socket.get_executor());
  const auto [unresolved, addresses] =
      co_await resolver.async_resolve(server.host, server.port, kAwait);
  if (unresolved) {
    co_return Loss{"cannot find " + server.host + ": " + unresolved.message()};
  }
  beast::tcp_stream& stream = beast::get_lowest_layer(socket);
  stream.expires_after(kConnectTimeout);
  const auto [unconnected, address] = co_await stream.async_connect(addresses, kAwait);
  if (unconnected) {
    co_return Loss{"cannot connect to " + server.host + ":" + server.port + ": " +
                   unconnected.message()};
  }
  stream.socket().set_option(tcp::no_delay(true));
  stream.expires_never();
  co_return std::nullopt;
}

asio::awaitable<std::optional<Loss>> upgrade(Socket& socket, const LinkSettings& settings) {
  socket.set_option(websocket::stream_base::timeout{.handshake_timeout = kConnectTimeout,
                                                    .idle_timeout = kIdleTimeout,
                                                    .keep_alive_pings = true});
  socket.set_option(websocket::stream_base::decorator([](websocket::request_type& request) {
    request.set(http::field::sec_websocket_protocol,
                beast::string_view(wire::kAgentProtocol.data(), wire::kAgentProtocol.size()));
  }));
  socket.read_message_max(wire::kMaxServerFrameBytes);
  websocket::response_type response;
  const std::string host = settings.server.host + ":" + settings.server.port;
  const std::string target = "/v1/sessions/" + settings.session + "/agent";
  const auto [failed] = co_await socket.async_handshake(response, host, target, kAwait);
  if (failed == websocket::error::upgrade_declined) {
    co_return declined(settings.session, response.result_int(), response.body());
  }
  if (failed) co_return Loss{"no WebSocket: " + failed.message()};
  if (response[http::field::sec_websocket_protocol] !=
      beast::string_view(wire::kAgentProtocol.data(), wire::kAgentProtocol.size())) {
    co_return Loss{"the server does not support " + std::string(wire::kAgentProtocol), true};
  }
  co_return std::nullopt;
}

/// Sends hello and waits for the welcome or an error.
asio::awaitable<std::expected<Welcome, Loss>> greet(Socket& socket, const Hello& greeting) {
  asio::steady_timer deadline(socket.get_executor(), kWelcomeTimeout);
  deadline.async_wait([&socket](error_code stopped) {
    if (!stopped) beast::get_lowest_layer(socket).close();
  });
  const std::string hello = hello_text(greeting);
  socket.text(true);
  const auto [unsent, sent] = co_await socket.async_write(asio::buffer(hello), kAwait);
  if (unsent)
    co_return std::unexpected(Loss{"the server closed the connection: " + unsent.message()});
  beast::flat_buffer frame;
  while (true) {
    frame.clear();
    const auto [unread, got] = co_await socket.async_read(frame, kAwait);
    if (unread) {
      co_return std::unexpected(Loss{"no welcome from the server: " + unread.message()});
    }
    if (!socket.got_text()) continue;
    const auto message = parse_control(beast::buffers_to_string(frame.data()));
    if (!message) {
      co_return std::unexpected(Loss{(message.error().fault == ControlFault::kOutOfRange
                                          ? "the server's welcome cannot be rendered: "
                                          : "cannot parse the server's welcome: ") +
                                         message.error().reason,
                                     true});
    }
    if (const auto* error = std::get_if<ServerError>(&*message)) {
      co_return std::unexpected(
          Loss{"the server rejected the agent: " + error->code + ": " + error->reason,
               error->code != wire::to_string(wire::ErrorCode::kBusy)});
    }
    if (const auto* bye = std::get_if<Bye>(&*message)) {
      co_return std::unexpected(Loss{"the server closed the connection: " + bye->reason});
    }
    if (const auto* welcome = std::get_if<Welcome>(&*message)) co_return *welcome;
  }
}

}  // namespace

asio::awaitable<std::expected<Welcome, Loss>> join(Connection& connection,
                                                   const LinkSettings& settings) {
  std::optional<Loss> rejected = co_await connect(connection.socket, settings.server);
  if (!rejected) rejected = co_await upgrade(connection.socket, settings);
  if (rejected) co_return std::unexpected(*rejected);
  co_return co_await greet(connection.socket, settings.hello);
}

}  // namespace kerf::agent
