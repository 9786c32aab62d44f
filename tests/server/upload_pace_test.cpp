// SPDX-License-Identifier: Apache-2.0
#include "server/http/upload_pace.h"

#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/server.h"
#include "tests/server/temporary_folder.h"

namespace kerf::net {
namespace {

using std::chrono::seconds;

TEST(UploadPace, AnUploadHasItsFirstSecondsAndThoseOfItsBytes) {
  EXPECT_EQ(UploadPace().time_for(0), seconds(30));
  EXPECT_EQ(UploadPace().time_for(256 * 1024 - 1), seconds(30));
  EXPECT_EQ(UploadPace().time_for(256 * 1024 * 60), seconds(90));
  const UploadPace other{.kilobytes_per_s = 2, .time_min = seconds(7)};
  EXPECT_EQ(other.time_for(4096), seconds(9));
  EXPECT_EQ(other.too_slow(), "an upload needs 2 kB/s after its first 7 s");
}

/// A TCP connection that sends a request in parts.
class Peer {
 public:
  explicit Peer(std::uint16_t port) : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const auto* generic = reinterpret_cast<const sockaddr*>(&address);
    EXPECT_EQ(connect(socket_, generic, sizeof address), 0);
  }
  ~Peer() { close(socket_); }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  bool send(std::string_view bytes) const {
    return ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) == std::ssize(bytes);
  }
  /// Waits for the whole answer, which is short.
  std::string answer() const {
    std::array<char, 4096> bytes{};
    const ssize_t read = recv(socket_, bytes.data(), bytes.size(), 0);
    return read > 0 ? std::string(bytes.data(), static_cast<std::size_t>(read)) : std::string();
  }
  bool is_answered() const {
    char first = 0;
    return recv(socket_, &first, 1, MSG_PEEK | MSG_DONTWAIT) == 1;
  }

 private:
  int socket_;
};

class SlowUpload : public testing::Test {
 protected:
  static constexpr std::size_t kBytes = 1000;  // all that one client may hold

  void start(const UploadPace& pace) {
    ServerOptions options;
    options.port = 0;
    options.udp.on = false;
    options.http.data_folder = folder_.path();
    options.http.upload_bytes = 2 * kBytes;
    options.http.upload_pace = pace;
    auto made = Server::create(options);
    ASSERT_TRUE(made) << made.error();
    server_ = std::move(*made);
    const auto listening = server_->listen();
    ASSERT_TRUE(listening) << listening.error();
  }
  /// Begins an upload of kBytes.
  std::unique_ptr<Peer> begin() const {
    auto peer = std::make_unique<Peer>(server_->port());
    const std::string head =
        "POST /v1/files?name=a.stl HTTP/1.1\r\nHost: localhost\r\n"
        "Content-Length: " +
        std::to_string(kBytes) + "\r\n\r\n";
    EXPECT_TRUE(peer->send(head));
    return peer;
  }

 private:
  test::TemporaryFolder folder_;
  std::unique_ptr<Server> server_;
};

TEST_F(SlowUpload, EndsWith408AndGivesItsMemoryBackAtOnce) {
  start({.kilobytes_per_s = 1'000'000, .time_min = seconds(0)});  // any is too slow
  // Each holds all that a client may, and keeps its connection open.
  std::vector<std::unique_ptr<Peer>> peers;
  for (int n = 0; n < 4; ++n) {
    peers.push_back(begin());
    for (std::size_t sent = 0; sent + 1 < kBytes && !peers.back()->is_answered(); ++sent) {
      if (!peers.back()->send(" ")) break;
    }
    const std::string answer = peers.back()->answer();
    EXPECT_TRUE(answer.starts_with("HTTP/1.1 408 ")) << answer;
    EXPECT_NE(answer.find("an upload needs 1000000 kB/s after its first 0 s"), std::string::npos);
  }
}

TEST_F(SlowUpload, OfAPaceThatIsAllowedIsRead) {
  start({.kilobytes_per_s = 1, .time_min = seconds(3600)});
  const auto peer = begin();
  for (std::size_t sent = 0; sent < kBytes; ++sent) ASSERT_TRUE(peer->send(" "));
  const std::string answer = peer->answer();
  EXPECT_TRUE(answer.starts_with("HTTP/1.1 400 ")) << answer;  // it is no model
}

TEST_F(SlowUpload, HoldsItsMemoryWhileItMayGoOn) {
  start({.kilobytes_per_s = 1, .time_min = seconds(3600)});
  {
    const auto unfinished = begin();
    std::string second;
    do {  // until the server has read the first header
      const auto peer = begin();
      ASSERT_TRUE(peer->send(std::string(kBytes, ' ')));
      second = peer->answer();
    } while (!second.starts_with("HTTP/1.1 503 "));
  }
  std::string later;
  do {  // until the server knows that the first one has gone
    const auto peer = begin();
    ASSERT_TRUE(peer->send(std::string(kBytes, ' ')));
    later = peer->answer();
  } while (later.starts_with("HTTP/1.1 503 "));
  EXPECT_TRUE(later.starts_with("HTTP/1.1 400 ")) << later;
}

}  // namespace
}  // namespace kerf::net
