// SPDX-License-Identifier: Apache-2.0
// TLS against peers that do not speak it; tests/server/live_tls_test.py has those that do.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <string_view>

#include "server/tls/tls_channel.h"

namespace kerf::net {
namespace {

class TlsTest : public testing::Test {
 protected:
  TlsTest() { EXPECT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, ends_.data()), 0); }
  ~TlsTest() override {
    close(ends_[0]);
    if (ends_[1] >= 0) close(ends_[1]);
  }
  /// A channel to `host` whose peer says this.
  std::unique_ptr<TlsChannel> channel(const std::string& host, std::string_view said) {
    const auto context = TlsContext::of_client({});
    EXPECT_TRUE(context) << context.error();
    auto made = std::make_unique<TlsChannel>(*context, ends_[0], host);
    EXPECT_EQ(made->handshake(), TlsStep::kWantsRead);  // its hello has left
    EXPECT_EQ(write(ends_[1], said.data(), said.size()), static_cast<ssize_t>(said.size()));
    return made;
  }
  void hang_up() { close(std::exchange(ends_[1], -1)); }

  std::array<int, 2> ends_{-1, -1};
};

TEST_F(TlsTest, AServerWithoutTlsIsNamedAndFinal) {
  const auto made = channel("kerf.example", "HTTP/1.1 400 Bad Request\r\n\r\n");
  EXPECT_EQ(made->handshake(), TlsStep::kFailed);
  EXPECT_TRUE(made->is_final());
  EXPECT_EQ(made->failure(), "kerf.example does not speak TLS on this port; use http://");
}

TEST_F(TlsTest, AConnectionThatIsLostDuringTheHandshakeMayBeTriedAgain) {
  const auto made = channel("127.0.0.1", "");
  hang_up();
  EXPECT_EQ(made->handshake(), TlsStep::kFailed);
  EXPECT_FALSE(made->is_final());
  EXPECT_FALSE(made->failure().empty());
}

TEST_F(TlsTest, AnAlertOfTheServerMayPass) {
  const auto made = channel("kerf.example", {"\x15\x03\x03\x00\x02\x02\x50", 7});
  EXPECT_EQ(made->handshake(), TlsStep::kFailed);
  EXPECT_FALSE(made->is_final()) << "an internal error of the server";
  EXPECT_NE(made->failure().find("internal error"), std::string::npos) << made->failure();
}

TEST_F(TlsTest, AServerThatSpeaksAnotherVersionIsFinal) {
  const auto made = channel("kerf.example", {"\x15\x03\x03\x00\x02\x02\x46", 7});
  EXPECT_EQ(made->handshake(), TlsStep::kFailed);
  EXPECT_TRUE(made->is_final());
  EXPECT_EQ(made->failure(), "kerf.example does not speak TLS 1.3");
}

TEST_F(TlsTest, AClosedPeerRaisesNoSignal) {
  const auto context = TlsContext::of_client({});
  ASSERT_TRUE(context);
  TlsChannel made(*context, ends_[0], "kerf.example");
  hang_up();
  EXPECT_EQ(made.handshake(), TlsStep::kFailed);  // SIGPIPE would end this program
  EXPECT_FALSE(made.is_final());
}

TEST_F(TlsTest, FilesThatCannotBeUsedAreNamed) {
  const auto server = TlsContext::of_server("/no/such/chain.pem", "/no/such/key.pem");
  ASSERT_FALSE(server);
  EXPECT_NE(server.error().find("/no/such/chain.pem"), std::string::npos);
  EXPECT_NE(server.error().find("No such file"), std::string::npos) << server.error();
  const auto client = TlsContext::of_client("/no/such/authority.pem");
  ASSERT_FALSE(client);
  EXPECT_NE(client.error().find("/no/such/authority.pem"), std::string::npos);
}

}  // namespace
}  // namespace kerf::net
