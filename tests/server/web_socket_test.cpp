// SPDX-License-Identifier: Apache-2.0
// A server's and a client's WebSocket over loopback.
#include "server/websocket/web_socket.h"

#include <sys/ioctl.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/streambuf.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/websocket/error.hpp>

#include "server/websocket/upgrade_request.h"
#include "tests/support/test.h"

namespace kerf::net::web_socket_test {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

constexpr WebSocketLimits kLimits{
    .handshake = std::chrono::seconds(5), .idle = std::chrono::seconds(20), .message_bytes = 1024};

/// Two connected TCP sockets; the first is a server's.
class WebSocketTest : public testing::Test {
 protected:
  WebSocketTest() : server_(io_), client_(io_) {
    tcp::acceptor acceptor(io_, tcp::endpoint(asio::ip::address_v4::loopback(), 0));
    client_.connect(acceptor.local_endpoint());
    acceptor.accept(server_);
  }

  /// Runs both coroutines to their ends and rethrows their exceptions. The client starts first,
  /// because the server waits for its request without yielding.
  template <class Server, class Client>
  void run(Server server, Client client) {
    const auto rethrow = [](const std::exception_ptr& error) {
      if (error) std::rethrow_exception(error);
    };
    asio::co_spawn(io_, std::move(client), rethrow);
    asio::co_spawn(io_, std::move(server), rethrow);
    io_.run();
  }

  /// Accepts a WebSocket that speaks `protocol` on the server's socket.
  asio::awaitable<std::unique_ptr<WebSocket>> accept(std::string_view protocol,
                                                     WebSocketLimits limits = kLimits) {
    UpgradeRequest request;
    boost::beast::flat_buffer buffer;
    boost::beast::http::read(server_, buffer, request.message);
    auto socket = std::make_unique<WebSocket>(std::move(server_), limits);
    const error_code error = co_await socket->accept(request, protocol);
    EXPECT_FALSE(error) << error.message();
    co_return socket;
  }

  asio::io_context io_;
  tcp::socket server_, client_;
  int client_handle_ = -1;
};

TEST_F(WebSocketTest, CarriesTextAndBinaryMessagesWhole) {
  const std::string first = "{\"a\":", second(900, 'x');
  run(
      [&]() -> asio::awaitable<void> {
        const auto socket = co_await accept("kerf.test");
        EXPECT_FALSE(co_await socket->read());
        EXPECT_TRUE(socket->is_text());
        EXPECT_EQ(socket->text(), "hello");
        const std::array<asio::const_buffer, 2> parts = {asio::buffer(first), asio::buffer(second)};
        bool written = false;
        socket->write(false, parts, [&](error_code error) { written = !error; });
        EXPECT_FALSE(co_await socket->read());
        EXPECT_TRUE(written);
        EXPECT_EQ(socket->message().size(), 3u);
        EXPECT_TRUE(co_await socket->read()) << "the client has closed";
      },
      [&]() -> asio::awaitable<void> {
        WebSocket socket(std::move(client_), kLimits);
        const HandshakeAnswer answer = co_await socket.shake_hands("localhost", "/x", "kerf.test");
        EXPECT_FALSE(answer.error) << answer.error.message();
        EXPECT_EQ(answer.protocol, "kerf.test");
        const std::string hello = "hello", end = "end";
        EXPECT_FALSE(co_await socket.write(true, asio::buffer(hello)));
        EXPECT_FALSE(co_await socket.read());
        EXPECT_FALSE(socket.is_text());
        EXPECT_EQ(socket.text(), first + second);
        EXPECT_FALSE(co_await socket.write(false, asio::buffer(end)));
        EXPECT_FALSE(co_await socket.close(1000));
      });
}

TEST_F(WebSocketTest, SilentPeerIsDroppedOnlyWhileReading) {
  WebSocketLimits limits = kLimits;
  limits.idle = std::chrono::milliseconds(50);
  const std::string hello = "hello";
  bool is_over = false;
  run(
      [&]() -> asio::awaitable<void> {
        const auto socket = co_await accept("kerf.test", limits);
        for (int n = 0; n < 2; ++n) {
          asio::steady_timer work(io_, 4 * limits.idle);  // it does not see the peer's pongs
          co_await work.async_wait(asio::use_awaitable);
          EXPECT_FALSE(co_await socket->read()) << n;
        }
        EXPECT_TRUE(co_await socket->read());
        is_over = true;
      },
      [&]() -> asio::awaitable<void> {
        WebSocket socket(std::move(client_), kLimits);  // reads nothing, so it answers no pings
        EXPECT_FALSE((co_await socket.shake_hands("localhost", "/", "kerf.test")).error);
        for (int n = 0; n < 2; ++n) {
          EXPECT_FALSE(co_await socket.write(true, asio::buffer(hello)));
        }
        asio::steady_timer pause(io_);
        while (!is_over) {
          pause.expires_after(std::chrono::milliseconds(5));
          co_await pause.async_wait(asio::use_awaitable);
        }
      });
}

TEST_F(WebSocketTest, HeldMessagesLeaveWithTheNextOne) {
  const std::string poses = "poses", tiles = "tiles", long_one(900, 'x');
  bool all_written = false;
  run(
      [&]() -> asio::awaitable<void> {
        const auto socket = co_await accept("kerf.test");
        int unread = 0;
        const auto arrived = [&] {
          ioctl(client_handle_, FIONREAD, &unread);
          return unread;
        };
        socket->hold(true);
        EXPECT_FALSE(co_await socket->write(false, asio::buffer(poses)));
        EXPECT_FALSE(co_await socket->write(false, asio::buffer(poses)));
        EXPECT_EQ(arrived(), 0);
        socket->hold(false);
        EXPECT_FALSE(co_await socket->write(false, asio::buffer(tiles)));
        EXPECT_EQ(arrived(), 3 * 7);
        // Nothing more is sent.
        socket->hold(true);
        EXPECT_FALSE(co_await socket->write(false, asio::buffer(poses)));
        EXPECT_EQ(arrived(), 3 * 7);
        socket->flush();
        socket->flush();
        EXPECT_EQ(arrived(), 4 * 7);
        // The operating system buffers more than this side holds back.
        for (int n = 0; n < 4; ++n)
          EXPECT_FALSE(co_await socket->write(false, asio::buffer(long_one)));
        EXPECT_EQ(arrived(), 4 * 7);
        socket->hold(false);
        EXPECT_FALSE(co_await socket->write(false, asio::buffer(tiles)));
        EXPECT_EQ(arrived(), 5 * 7 + 4 * 904);
        all_written = true;
        EXPECT_TRUE(co_await socket->read()) << "the client has closed";
      },
      [&]() -> asio::awaitable<void> {
        client_handle_ = client_.native_handle();
        WebSocket socket(std::move(client_), kLimits);
        EXPECT_FALSE((co_await socket.shake_hands("localhost", "/", "kerf.test")).error);
        asio::steady_timer pause(io_);
        while (!all_written) {
          pause.expires_after(std::chrono::milliseconds(1));
          co_await pause.async_wait(asio::use_awaitable);
        }
        for (const std::string& text :
             {poses, poses, tiles, poses, long_one, long_one, long_one, long_one, tiles}) {
          EXPECT_FALSE(co_await socket.read());
          EXPECT_EQ(socket.text(), text);
        }
        EXPECT_FALSE(co_await socket.close(1000));
      });
}

TEST_F(WebSocketTest, ALongerMessageThanTheLimitEndsTheConnection) {
  run(
      [&]() -> asio::awaitable<void> {
        const auto socket = co_await accept("kerf.test");
        EXPECT_TRUE(co_await socket->read());
      },
      [&]() -> asio::awaitable<void> {
        WebSocket socket(std::move(client_), kLimits);
        co_await socket.shake_hands("localhost", "/x", "kerf.test");
        const std::string bytes(kLimits.message_bytes + 1, 'x');
        EXPECT_FALSE(co_await socket.write(false, asio::buffer(bytes)));
        EXPECT_TRUE(co_await socket.read());
      });
}

TEST_F(WebSocketTest, HeldMessagesAndCloseFrameArriveBeforeTheEnd) {
  const std::string poses = "poses";
  run(
      [&]() -> asio::awaitable<void> {
        const auto socket = co_await accept("kerf.test");
        socket->hold(true);
        EXPECT_FALSE(co_await socket->write(false, asio::buffer(poses)));
        EXPECT_TRUE(co_await socket->read()) << "the message is too long";
      },
      [&]() -> asio::awaitable<void> {
        WebSocket socket(std::move(client_), kLimits);
        co_await socket.shake_hands("localhost", "/x", "kerf.test");
        const std::string bytes(kLimits.message_bytes + 1, 'x');
        EXPECT_FALSE(co_await socket.write(false, asio::buffer(bytes)));
        EXPECT_FALSE(co_await socket.read());
        EXPECT_EQ(socket.text(), poses);
        EXPECT_EQ(co_await socket.read(), boost::beast::websocket::error::closed);
      });
}

TEST_F(WebSocketTest, AServerThatDeclinesIsReportedWithStatusAndBody) {
  run(
      [&]() -> asio::awaitable<void> {
        const std::string answer = "HTTP/1.1 404 Not Found\r\nContent-Length: 7\r\n\r\nnothing";
        asio::write(server_, asio::buffer(answer));
        co_return;
      },
      [&]() -> asio::awaitable<void> {
        WebSocket socket(std::move(client_), kLimits);
        const HandshakeAnswer answer = co_await socket.shake_hands("localhost", "/x", "kerf.test");
        EXPECT_TRUE(answer.error);
        EXPECT_EQ(answer.declined_status, 404u);
        EXPECT_EQ(answer.declined_body, "nothing");
      });
}

TEST_F(WebSocketTest, CuttingEndsAReadInProgress) {
  std::unique_ptr<WebSocket> socket;
  run(
      [&]() -> asio::awaitable<void> {
        socket = co_await accept("kerf.test");
        EXPECT_TRUE(co_await socket->read());
        socket.reset();  // and its timer
      },
      [&]() -> asio::awaitable<void> {
        WebSocket client(std::move(client_), kLimits);
        co_await client.shake_hands("localhost", "/x", "kerf.test");
        asio::post(io_, [&] { socket->cut(); });
        EXPECT_TRUE(co_await client.read());
      });
}

}  // namespace
}  // namespace kerf::net::web_socket_test
