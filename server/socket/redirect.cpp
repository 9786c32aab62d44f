// SPDX-License-Identifier: Apache-2.0
// A peer whose session is at another server. Its WebSocket is accepted, because a browser does not
// follow an HTTP redirect to one, and ended with a bye that names the server.
#include <boost/asio/buffer.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <chrono>
#include <memory>
#include <utility>

#include "server/conversation/control_json.h"
#include "server/socket/peer_socket.h"
#include "server/socket/serve_peer.h"
#include "server/websocket/web_socket.h"

namespace kerf::net {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

constexpr WebSocketLimits kShortLimits{
    .handshake = std::chrono::seconds(5),
    .idle = std::chrono::seconds(5),
    .message_bytes = std::size_t{64} * 1024,
};

/// A WebSocket with the bye that ends it.
struct Leaving {
  WebSocket socket;
  UpgradeRequest request;
  std::string_view protocol;
  std::string bye;
};

asio::awaitable<void> redirect(std::shared_ptr<Leaving> peer) {
  const error_code refused = co_await peer->socket.accept(peer->request, peer->protocol);
  if (refused) co_return;
  const error_code unsent = co_await peer->socket.write(true, asio::buffer(peer->bye));
  if (!unsent) co_await peer->socket.close(kGoingAway);
}

}  // namespace

void serve_redirect(ByteStream stream, UpgradeRequest request, std::string_view protocol,
                    const std::string& address) {
  auto peer = std::shared_ptr<Leaving>(
      new Leaving{WebSocket(std::move(stream), kShortLimits), std::move(request), protocol,
                  bye_message("the session is at " + address, address)});
  const auto executor = peer->socket.executor();
  auto run = [peer = std::move(peer)]() -> asio::awaitable<void> { return redirect(peer); };
  asio::co_spawn(executor, std::move(run), asio::detached);
}

}  // namespace kerf::net
