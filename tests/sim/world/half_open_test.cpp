// SPDX-License-Identifier: Apache-2.0
// Connections to a server with TLS that do not get as far as a request.
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/server/certificates.h"
#include "tests/sim/world/cluster.h"

namespace kerf::sim::half_open_test {
namespace {

/// The first bytes of a hello of TLS, and nothing more.
class HalfHello {
 public:
  explicit HalfHello(int port) : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    EXPECT_EQ(connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    constexpr std::string_view kBegin("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11);
    EXPECT_EQ(send(socket_, kBegin.data(), kBegin.size(), MSG_NOSIGNAL), 11);
  }
  ~HalfHello() { close(socket_); }
  HalfHello(const HalfHello&) = delete;
  HalfHello& operator=(const HalfHello&) = delete;
  bool is_closed() const {
    char next = 0;
    return recv(socket_, &next, 1, MSG_DONTWAIT | MSG_PEEK) == 0;
  }

 private:
  int socket_;
};

class HalfOpen : public ClusterTest {
 protected:
  void SetUp() override { test::certify(certificate_.path() / "own"); }
  void start(Cluster& servers) const {
    servers.start("a", [this](net::ServerOptions& options) {
      options.copies.url.clear();
      options.cluster.node.clear();
      options.needs_copy = false;
      options.connections_max = 3;
      options.tls_certificate = certificate_.path() / "own.pem";
      options.tls_key = certificate_.path() / "own.key";
    });
  }

 private:
  const test::TemporaryFolder certificate_;
};

TEST_F(HalfOpen, HalfAHandshakeCountsAsAConnectionAndIsClosedInTime) {
  EXPECT_EQ(faults_of([this](Cluster& servers) {
              start(servers);
              sleep_until(now() + 10 * kSecond);  // the request of the start has left
              std::vector<std::unique_ptr<HalfHello>> hellos;
              for (int n = 0; n < 4; ++n) {
                hellos.push_back(std::make_unique<HalfHello>(servers.at("a").port()));
                sleep_until(now() + 10 * kMillisecond);
              }
              EXPECT_TRUE(hellos.front()->is_closed()) << "for the fourth there was no place";
              for (int n = 1; n < 4; ++n) EXPECT_FALSE(hellos.at(n)->is_closed()) << n;
              EXPECT_TRUE(servers.until([&] {
                return hellos[1]->is_closed() && hellos[2]->is_closed() && hellos[3]->is_closed();
              }));
            }),
            "");
}

TEST_F(HalfOpen, WhoSpeaksHttpIsSentToHttps) {
  EXPECT_EQ(faults_of([this](Cluster& servers) {
              start(servers);
              const auto answer = servers.ask("a", "GET", "/healthz");
              EXPECT_EQ(answer.status, 400);
              EXPECT_TRUE(answer.body.contains("tls_required")) << answer.body;
              EXPECT_TRUE(answer.body.contains("use https://")) << answer.body;
            }),
            "");
}

}  // namespace
}  // namespace kerf::sim::half_open_test
