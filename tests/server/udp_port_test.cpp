// SPDX-License-Identifier: Apache-2.0
#include "server/udp/udp_port.h"

#include <arpa/inet.h>
#include <unistd.h>

#include "server/datagram/cipher.h"
#include "server/metrics/metrics.h"
#include "tests/server/session_fixture.h"
#include "tests/support/eventually.h"
#include "tests/support/test.h"

namespace kerf::net::udp_port_test {
namespace {

using Bytes = std::vector<std::byte>;

TEST(UdpAddress, ReadsNumericAddressesOnly) {
  ASSERT_TRUE(to_address("127.0.0.1", 80));
  EXPECT_EQ(to_address("127.0.0.1", 80)->peer.ss_family, AF_INET);
  ASSERT_TRUE(to_address("::1", 80));
  EXPECT_EQ(to_address("::1", 80)->peer.ss_family, AF_INET6);
  for (const char* bad : {"", "localhost", "127.0.0", "[::1]"}) {
    EXPECT_FALSE(to_address(bad, 80)) << bad;
  }
}

/// An IPv4 socket with a receive timeout of 5 s, which only a failed test reaches.
int open_socket() {
  const int opened = ::socket(AF_INET, SOCK_DGRAM, 0);
  EXPECT_GE(opened, 0);
  const timeval limit{5, 0};
  ::setsockopt(opened, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  return opened;
}

/// A port on the loopback interface, one peer, and a client socket that knows the peer's keys.
class UdpPortTest : public SessionTest {
 protected:
  void SetUp() override {
    SessionTest::SetUp();
    ASSERT_TRUE(port.listen("127.0.0.1", 0));
    peer = port.open(posted, [this](std::span<const std::byte> frame, auto) {
      frames.emplace_back(frame.begin(), frame.end());
    });
    ASSERT_TRUE(peer);
    client = open_socket();
    server = *to_address("127.0.0.1", port.port());
    ASSERT_EQ(::connect(client, reinterpret_cast<const sockaddr*>(&server.peer), server.peer_bytes),
              0);
  }
  void TearDown() override { ::close(client); }

  Bytes seal(std::span<const std::byte> frame) {
    Bytes datagram(datagram::kMaxBytes);
    datagram.resize(sealer().seal(frame, datagram));
    return datagram;
  }
  datagram::Sealer& sealer() {
    if (!sealer_) sealer_.emplace(peer->offer().connection, peer->offer().to_server);
    return *sealer_;
  }
  void send(const Bytes& datagram) {
    ASSERT_EQ(::send(client, datagram.data(), datagram.size(), 0),
              static_cast<ssize_t>(datagram.size()));
  }
  /// Waits until the metrics contain the line. Only a failed test reaches the bound.
  bool becomes(const std::string& line) {
    for (int n = 0; n < 1000; ++n) {
      if (metrics.text(*registry).contains("\n" + line + "\n")) return true;
      ::usleep(5000);
    }
    return false;
  }

  class LockedExecutor final : public Executor {
   public:
    void post(Work work) override {
      const std::scoped_lock lock(mutex_);
      queue_.push_back(std::move(work));
    }
    void post_after(std::chrono::microseconds, Work) override {}
    std::size_t run() {
      std::vector<Work> work;
      {
        const std::scoped_lock lock(mutex_);
        work.swap(queue_);
      }
      for (Work& one : work) one();
      return work.size();
    }

   private:
    std::mutex mutex_;
    std::vector<Work> queue_;
  };

  Metrics metrics;
  LockedExecutor posted;
  UdpPort port{metrics};
  std::shared_ptr<UdpPeer> peer;
  std::vector<Bytes> frames;
  UdpAddress server;
  int client = -1;

 private:
  std::optional<datagram::Sealer> sealer_;
};

constexpr std::string_view kReceived = "kerf_datagrams_received_total 1";

TEST_F(UdpPortTest, PostsTheOpenedFrameToTheExecutorAndAnswersTheSender) {
  const Bytes frame(40, std::byte{7});
  send(seal(frame));
  ASSERT_TRUE(becomes(std::string(kReceived)));
  EXPECT_EQ(posted.run(), 1U);
  EXPECT_EQ(frames, std::vector<Bytes>{frame});
  const Bytes answer(30, std::byte{9});
  peer->send(answer);
  Bytes received(datagram::kMaxBytes);
  const ssize_t count = ::recv(client, received.data(), received.size(), 0);
  ASSERT_GT(count, 0);
  datagram::Opener opener(peer->offer().connection, peer->offer().to_agent);
  std::array<std::byte, datagram::kMaxFrameBytes> opened{};
  const auto result = test::value_of(
      opener.open(std::span(received).first(static_cast<std::size_t>(count)), opened));
  EXPECT_EQ(Bytes(opened.begin(), opened.begin() + static_cast<long>(result.frame_bytes)), answer);
}

TEST_F(UdpPortTest, CountsWhyADatagramIsDropped) {
  const Bytes frame(40, std::byte{7});
  Bytes tampered = seal(frame);
  tampered.back() ^= std::byte{1};
  send(tampered);
  EXPECT_TRUE(becomes("kerf_datagrams_dropped_total{reason=\"not_authentic\"} 1"));
  send(Bytes(10));
  EXPECT_TRUE(becomes("kerf_datagrams_dropped_total{reason=\"malformed\"} 1"));
  const Bytes good = seal(frame);
  send(good);
  send(good);
  EXPECT_TRUE(becomes("kerf_datagrams_dropped_total{reason=\"replayed\"} 1"));
  port.close(*peer);
  send(seal(frame));
  EXPECT_TRUE(becomes("kerf_datagrams_dropped_total{reason=\"unknown_connection\"} 1"));
  EXPECT_TRUE(becomes(std::string(kReceived)));
}

TEST_F(UdpPortTest, DropsDatagramsBeyondTheWaitingLimit) {
  const Bytes frame(40, std::byte{7});
  for (int n = 0; n < UdpPeer::kWaitingMax + 3; ++n) send(seal(frame));
  EXPECT_TRUE(becomes("kerf_datagrams_dropped_total{reason=\"too_many\"} 3"));
  EXPECT_EQ(posted.run(), static_cast<std::size_t>(UdpPeer::kWaitingMax));
}

TEST_F(UdpPortTest, SendsNothingBeforeTheFirstDatagramOfTheAgent) {
  peer->send(Bytes(30, std::byte{9}));
  EXPECT_TRUE(becomes("kerf_datagrams_sent_total 0"));
}

/// Sends from another socket, as an agent behind another address does.
class Elsewhere {
 public:
  explicit Elsewhere(const UdpAddress& server) : server_(server) {}
  ~Elsewhere() { ::close(socket_); }
  Elsewhere(const Elsewhere&) = delete;
  Elsewhere& operator=(const Elsewhere&) = delete;
  void send(const Bytes& datagram) const {
    EXPECT_EQ(::sendto(socket_, datagram.data(), datagram.size(), 0,
                       reinterpret_cast<const sockaddr*>(&server_.peer), server_.peer_bytes),
              static_cast<ssize_t>(datagram.size()));
  }
  /// Returns the sender of the next datagram; empty if there is none.
  std::string source(int flags = 0) const {
    std::array<char, 2048> bytes{};
    sockaddr_in from{};
    socklen_t size = sizeof from;
    if (::recvfrom(socket_, bytes.data(), bytes.size(), flags, reinterpret_cast<sockaddr*>(&from),
                   &size) < 0) {
      return {};
    }
    std::array<char, INET_ADDRSTRLEN> text{};
    ::inet_ntop(AF_INET, &from.sin_addr, text.data(), text.size());
    return text.data();
  }

 private:
  UdpAddress server_;
  int socket_ = open_socket();
};

TEST_F(UdpPortTest, AnswersGoToTheSourceOfTheNewestDatagram) {
  const Bytes frame(40, std::byte{7});
  const Bytes old = seal(frame);
  send(seal(frame));
  ASSERT_TRUE(becomes("kerf_datagrams_received_total 1"));
  const Elsewhere stranger(server), moved(server);
  stranger.send(old);  // delayed by an attacker
  ASSERT_TRUE(becomes("kerf_datagrams_received_total 2"));
  peer->send(frame);
  Bytes answer(datagram::kMaxBytes);
  EXPECT_GT(::recv(client, answer.data(), answer.size(), 0), 0);
  moved.send(seal(frame));  // the agent, behind a NAT that has lost its mapping
  ASSERT_TRUE(becomes("kerf_datagrams_received_total 3"));
  peer->send(frame);
  EXPECT_EQ(moved.source(), "127.0.0.1");
  EXPECT_EQ(stranger.source(MSG_DONTWAIT), "");
}

TEST_F(UdpPortTest, AnswersComeFromTheAddressThatTheAgentUses) {
  for (const char* all : {"0.0.0.0", "::"}) {
    UdpPort wide(metrics);
    ASSERT_TRUE(wide.listen(all, 0));
    for (const char* host : {"127.0.0.1", "127.0.0.2"}) {
      const auto agents = wide.open(posted, [](std::span<const std::byte>, auto) {});
      datagram::Sealer own(agents->offer().connection, agents->offer().to_server);
      Bytes sealed(datagram::kMaxBytes);
      sealed.resize(own.seal(Bytes(40), sealed));
      const Elsewhere agent(*to_address(host, wide.port()));
      agent.send(sealed);
      ASSERT_TRUE(test::eventually([this] { return posted.run() == 1; }));
      agents->send(Bytes(30));
      EXPECT_EQ(agent.source(), host) << all;
      wide.close(*agents);
    }
  }
}

}  // namespace
}  // namespace kerf::net::udp_port_test
