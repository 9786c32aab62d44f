// SPDX-License-Identifier: Apache-2.0
// Establishes a connection, up to the welcome.
#include "haptic_agent/link/connection.h"

#include <boost/asio/connect.hpp>
#include <chrono>
#include <memory>

#include "server/wire/control.h"
#include "server/wire/limits.h"

namespace kerf::agent {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using std::chrono::seconds;

constexpr seconds kConnectTimeout{3};
constexpr seconds kWelcomeTimeout{5};
/// The server may have to load the session first.
constexpr seconds kUpgradeTimeout{8};
static_assert(kUpgradeTimeout > seconds(wire::kLoadWaitS));
constexpr net::WebSocketLimits kLimits{
    .handshake = kUpgradeTimeout,
    .idle = seconds(6),
    .message_bytes = wire::kMaxServerFrameBytes,
};

/// Cuts the connection after `time` unless cancelled or destroyed before.
class Deadline {
 public:
  Deadline(Connection& connection, seconds time) : timer_(connection.tcp.get_executor(), time) {
    // When the timer is destroyed, the wait may already have ended and its handler be queued.
    timer_.async_wait([&connection, alive = std::weak_ptr(alive_)](error_code stopped) {
      if (!stopped && !alive.expired()) connection.cut();
    });
  }

 private:
  std::shared_ptr<bool> alive_ = std::make_shared<bool>(true);
  asio::steady_timer timer_;
};

asio::awaitable<std::optional<Loss>> connect(Connection& connection, const LinkSettings& settings) {
  const ServerUrl& server = settings.server;
  std::optional<net::TlsContext> context;
  if (server.tls) {
    auto made = net::TlsContext::of_client(settings.authorities);
    if (!made) co_return Loss{made.error(), true};
    context = *std::move(made);
  }
  tcp::resolver resolver(connection.tcp.get_executor());
  const auto [unresolved, addresses] =
      co_await resolver.async_resolve(server.host, server.port, kAwait);
  if (unresolved) {
    co_return Loss{"cannot find " + server.host + ": " + unresolved.message()};
  }
  const Deadline deadline(connection, kConnectTimeout);
  const auto [unconnected, address] =
      co_await asio::async_connect(connection.tcp, addresses, kAwait);
  if (unconnected) {
    const bool late = unconnected == asio::error::operation_aborted;
    co_return Loss{"cannot connect to " + server.authority() + ": " +
                   (late ? "no answer within 3 s" : unconnected.message())};
  }
  connection.tcp.set_option(tcp::no_delay(true));
  std::unique_ptr<net::TlsChannel> tls;
  if (context) {
    tls = std::make_unique<net::TlsChannel>(*context, connection.tcp.native_handle(), server.host);
  }
  connection.stream.emplace(std::move(connection.tcp), std::move(tls));
  const error_code unsafe = co_await connection.stream->shake_hands();
  if (unsafe == asio::error::operation_aborted) {
    co_return Loss{"no TLS with " + server.authority() + ": no answer within 3 s"};
  }
  if (unsafe) {
    const net::TlsChannel& channel = *connection.stream->tls();
    co_return Loss{channel.failure(), channel.is_final()};
  }
  connection.socket = std::make_unique<net::WebSocket>(*std::move(connection.stream), kLimits);
  co_return std::nullopt;
}

asio::awaitable<std::optional<Loss>> upgrade(net::WebSocket& socket, const LinkSettings& settings) {
  const std::string host = settings.server.authority();
  const std::string target = "/v1/sessions/" + settings.session + "/agent";
  const net::HandshakeAnswer answer =
      co_await socket.shake_hands(host, target, wire::kAgentProtocol, settings.token);
  if (answer.declined_status != 0) {
    co_return declined(settings.session, answer.declined_status, answer.declined_body);
  }
  if (answer.error) co_return Loss{"no WebSocket: " + answer.error.message()};
  if (answer.protocol != wire::kAgentProtocol) {
    co_return Loss{"the server does not support " + std::string(wire::kAgentProtocol), true};
  }
  co_return std::nullopt;
}

/// Sends hello and waits for the welcome or an error.
asio::awaitable<std::expected<Welcome, Loss>> greet(Connection& connection, const Hello& greeting) {
  net::WebSocket& socket = *connection.socket;
  const Deadline deadline(connection, kWelcomeTimeout);
  const std::string hello = hello_text(greeting);
  const error_code unsent = co_await socket.write(true, asio::buffer(hello));
  if (unsent) {
    co_return std::unexpected(Loss{"the server closed the connection: " + unsent.message()});
  }
  while (true) {
    const error_code unread = co_await socket.read();
    if (unread) {
      co_return std::unexpected(Loss{"no welcome from the server: " + unread.message()});
    }
    if (!socket.is_text()) continue;
    const auto message = parse_control(socket.text());
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
      co_return std::unexpected(
          Loss{"the server closed the connection: " + bye->reason, false, bye->redirect});
    }
    if (const auto* welcome = std::get_if<Welcome>(&*message)) co_return *welcome;
  }
}

}  // namespace

void Connection::cut() {
  if (socket) return socket->cut();
  if (stream) return stream->close();
  error_code ignored;
  tcp.close(ignored);
}

asio::awaitable<std::expected<Welcome, Loss>> join(Connection& connection,
                                                   const LinkSettings& settings) {
  std::optional<Loss> rejected = co_await connect(connection, settings);
  if (!rejected) rejected = co_await upgrade(*connection.socket, settings);
  if (rejected) co_return std::unexpected(*rejected);
  co_return co_await greet(connection, settings.hello);
}

}  // namespace kerf::agent
