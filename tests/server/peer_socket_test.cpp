// SPDX-License-Identifier: Apache-2.0
// A peer's connection over loopback, with a conversation that a test controls.
#include "server/socket/peer_socket.h"

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/read.hpp>

#include "server/websocket/upgrade_request.h"
#include "tests/server/session_fixture.h"

namespace kerf::net {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

/// More than the socket buffers of both sides hold.
constexpr std::size_t kLongFrameBytes = std::size_t{64} << 20;

/// Sends one long frame.
class LongConversation final : public Conversation {
 public:
  LongConversation(std::shared_ptr<Session> session, Metrics& metrics)
      : Conversation(std::move(session), metrics, Clock::now, {}, {}) {}
  bool take(OutFrame& out) override {
    if (std::exchange(taken_, true)) return false;
    out = {.kind = OutFrame::Kind::kMesh, .bytes = std::vector<std::byte>(kLongFrameBytes)};
    return true;
  }
  void end() override {}

 private:
  void on_hello(const HelloMessage&) override {}
  void on_control(const ControlMessage&) override {}
  void on_message(const wire::Message&, Clock::time_point) override {}
  bool queue_text(std::string_view) override { return true; }
  void queue_pong(const wire::FrameStamp&, const wire::Pong&) override {}
  void discard_updates() override {}

  bool taken_ = false;
};

class LongPeer final : public PeerSocket {
 public:
  LongPeer(tcp::socket socket, Conversation& conversation, bool& is_closed)
      : PeerSocket(ByteStream(std::move(socket)), "kerf.test", -1, std::chrono::milliseconds(20)),
        conversation_(conversation),
        is_closed_(is_closed) {}
  using PeerSocket::pump;

 private:
  Conversation& conversation() override { return conversation_; }
  void closed() override { is_closed_ = true; }

  Conversation& conversation_;
  bool& is_closed_;
};

class PeerSocketTest : public SessionTest {};

TEST_F(PeerSocketTest, APeerThatDoesNotReadIsDisconnectedWhenItsConversationEnds) {
  Metrics metrics;
  LongConversation conversation(start(), metrics);
  bool is_closed = false;
  asio::io_context io;
  tcp::socket accepted(io), client(io);
  tcp::acceptor acceptor(io, tcp::endpoint(asio::ip::address_v4::loopback(), 0));
  client.connect(acceptor.local_endpoint());
  acceptor.accept(accepted);
  WebSocket reader(std::move(client), {.handshake = std::chrono::seconds(5),
                                       .idle = std::chrono::seconds(20),
                                       .message_bytes = 1024});
  std::weak_ptr<LongPeer> peer;
  asio::co_spawn(
      io,
      [&]() -> asio::awaitable<void> {
        const auto answer = co_await reader.shake_hands("localhost", "/x", "kerf.test");
        EXPECT_FALSE(answer.error) << answer.error.message();
        conversation.grant_expired();
        if (const auto here = peer.lock()) here->pump();
      },
      asio::detached);
  asio::post(io, [&] {
    UpgradeRequest request;
    boost::beast::flat_buffer buffer;
    boost::beast::http::read(accepted, buffer, request.message);
    const auto made = std::make_shared<LongPeer>(std::move(accepted), conversation, is_closed);
    peer = made;
    made->start(std::move(request));
  });
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (!is_closed && std::chrono::steady_clock::now() < end) {
    io.run_one_for(std::chrono::milliseconds(10));
  }
  EXPECT_TRUE(is_closed);
}

}  // namespace
}  // namespace kerf::net
