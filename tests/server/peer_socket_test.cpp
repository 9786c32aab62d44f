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

namespace kerf::net::peer_socket_test {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

/// Larger than the socket buffers of both sides.
constexpr std::size_t kLongFrameBytes = std::size_t{64} << 20;

/// Sends one frame. With `promises_more` it announces another one that never comes.
class OneFrame final : public Conversation {
 public:
  OneFrame(std::shared_ptr<Session> session, Metrics& metrics, std::size_t bytes,
           bool promises_more = false)
      : Conversation(std::move(session), metrics, Clock::now, {}, {}),
        bytes_(bytes),
        promises_more_(promises_more) {}
  bool take(OutFrame& out) override {
    if (std::exchange(taken_, true)) return false;
    out = {.kind = OutFrame::Kind::kMesh, .bytes = std::vector<std::byte>(bytes_)};
    return true;
  }
  bool has_more() const override { return promises_more_; }
  void end() override {}

 private:
  void on_hello(const HelloMessage&) override {}
  void on_control(const ControlMessage&) override {}
  void on_message(const wire::Message&, Clock::time_point) override {}
  bool queue_text(std::string_view) override { return true; }
  void queue_pong(const wire::FrameStamp&, const wire::Pong&) override {}
  void discard_updates() override {}

  std::size_t bytes_;
  bool promises_more_, taken_ = false;
};

class Peer final : public PeerSocket {
 public:
  Peer(tcp::socket socket, Conversation& conversation, bool& is_closed)
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

class PeerSocketTest : public SessionTest {
 protected:
  PeerSocketTest() : accepted_(io_), client_(io_) {
    tcp::acceptor acceptor(io_, tcp::endpoint(asio::ip::address_v4::loopback(), 0));
    client_.connect(acceptor.local_endpoint());
    acceptor.accept(accepted_);
  }
  /// Starts the peer once the client has asked for a WebSocket.
  void accept(Conversation& conversation) {
    asio::post(io_, [&] {
      UpgradeRequest request;
      boost::beast::flat_buffer buffer;
      boost::beast::http::read(accepted_, buffer, request.message);
      const auto made = std::make_shared<Peer>(std::move(accepted_), conversation, is_closed_);
      peer_ = made;
      made->start(std::move(request));
    });
  }
  void run_until(const bool& done) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(5);
    while (!done && std::chrono::steady_clock::now() < end) {
      io_.run_one_for(std::chrono::milliseconds(10));
    }
  }

  Metrics metrics_;
  asio::io_context io_;
  tcp::socket accepted_, client_;
  bool is_closed_ = false;
  std::weak_ptr<Peer> peer_;
};

constexpr WebSocketLimits kClientLimits{
    .handshake = std::chrono::seconds(5), .idle = std::chrono::seconds(20), .message_bytes = 1024};

TEST_F(PeerSocketTest, StalledPeerIsDisconnectedWhenItsConversationEnds) {
  OneFrame conversation(start(), metrics_, kLongFrameBytes);
  WebSocket reader(std::move(client_), kClientLimits);
  asio::co_spawn(
      io_,
      [&]() -> asio::awaitable<void> {
        const auto answer = co_await reader.shake_hands("localhost", "/x", "kerf.test");
        EXPECT_FALSE(answer.error) << answer.error.message();
        conversation.grant_expired();
        if (const auto here = peer_.lock()) here->pump();
      },
      asio::detached);
  accept(conversation);
  run_until(is_closed_);
  EXPECT_TRUE(is_closed_);
}

TEST_F(PeerSocketTest, FrameArrivesEvenIfThePromisedNextOneIsDropped) {
  OneFrame conversation(start(), metrics_, 10, true);
  WebSocket reader(std::move(client_), kClientLimits);
  bool has_arrived = false;
  asio::co_spawn(
      io_,
      [&]() -> asio::awaitable<void> {
        const auto answer = co_await reader.shake_hands("localhost", "/x", "kerf.test");
        EXPECT_FALSE(answer.error) << answer.error.message();
        has_arrived = !co_await reader.read() && reader.message().size() == 10;
      },
      asio::detached);
  accept(conversation);
  run_until(has_arrived);
  EXPECT_TRUE(has_arrived);
  reader.cut();
  run_until(is_closed_);
}

}  // namespace
}  // namespace kerf::net::peer_socket_test
