// SPDX-License-Identifier: Apache-2.0
// TLS channels against each other, and against peers that do not speak TLS.
#include <fcntl.h>
#include <openssl/ssl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <regex>

#include "server/tls/tls_channel.h"
#include "server/tls/tls_context.h"
#include "tests/server/certificates.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::net::tls_test {
namespace {

class TlsTest : public testing::Test {
 protected:
  TlsTest() { EXPECT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, ends_.data()), 0); }
  ~TlsTest() override {
    close(ends_[0]);
    if (ends_[1] >= 0) close(ends_[1]);
  }
  /// A channel to `host` whose peer sends `said`.
  std::unique_ptr<TlsChannel> channel(const std::string& host, std::string_view said) {
    const auto context = TlsContext::of_client({});
    EXPECT_TRUE(context) << context.error();
    auto made = std::make_unique<TlsChannel>(*context, ends_[0], host);
    EXPECT_EQ(made->handshake(), TlsStep::kWantsRead);  // its hello has been sent
    EXPECT_EQ(write(ends_[1], said.data(), said.size()), static_cast<ssize_t>(said.size()));
    return made;
  }
  void hang_up() { close(std::exchange(ends_[1], -1)); }

  std::array<int, 2> ends_{-1, -1};
};

TEST_F(TlsTest, ServerWithoutTlsIsAFinalError) {
  const auto made = channel("kerf.example", "HTTP/1.1 400 Bad Request\r\n\r\n");
  EXPECT_EQ(made->handshake(), TlsStep::kFailed);
  EXPECT_TRUE(made->is_final());
  EXPECT_EQ(made->failure(), "kerf.example does not speak TLS on this port; use http://");
}

TEST_F(TlsTest, ConnectionLostInTheHandshakeMayBeRetried) {
  const auto made = channel("127.0.0.1", "");
  hang_up();
  EXPECT_EQ(made->handshake(), TlsStep::kFailed);
  EXPECT_FALSE(made->is_final());
  EXPECT_FALSE(made->failure().empty());
}

TEST_F(TlsTest, ServerAlertMayBeRetried) {
  const auto made = channel("kerf.example", {"\x15\x03\x03\x00\x02\x02\x50", 7});
  EXPECT_EQ(made->handshake(), TlsStep::kFailed);
  EXPECT_FALSE(made->is_final()) << "an internal error of the server";
  EXPECT_NE(made->failure().find("internal error"), std::string::npos) << made->failure();
}

TEST_F(TlsTest, UnsupportedVersionIsAFinalError) {
  const auto made = channel("kerf.example", {"\x15\x03\x03\x00\x02\x02\x46", 7});
  EXPECT_EQ(made->handshake(), TlsStep::kFailed);
  EXPECT_TRUE(made->is_final());
  EXPECT_EQ(made->failure(), "kerf.example does not speak TLS 1.3");
}

TEST_F(TlsTest, AClosedPeerRaisesNoSignal) {
  const auto context = test::value_of(TlsContext::of_client({}));
  TlsChannel made(context, ends_[0], "kerf.example");
  hang_up();
  EXPECT_EQ(made.handshake(), TlsStep::kFailed);  // SIGPIPE would end this program
  EXPECT_FALSE(made.is_final());
}

/// A server and a client at the two ends.
class TlsPair : public TlsTest {
 protected:
  void SetUp() override { test::certify(folder_ / "good"); }
  TlsContext server(const char* name) const {
    return TlsContext::of_server(folder_ / (std::string(name) + ".pem"),
                                 folder_ / (std::string(name) + ".key"))
        .value();
  }
  TlsContext client(const char* authority) const {
    return TlsContext::of_client(folder_ / (std::string(authority) + ".pem")).value();
  }
  static bool is_waiting(TlsStep step) {
    return step == TlsStep::kWantsRead || step == TlsStep::kWantsWrite;
  }
  /// Shakes hands. Returns whether both sides succeeded.
  static bool shake(TlsChannel& server, TlsChannel& client) {
    TlsStep there = TlsStep::kWantsRead, here = TlsStep::kWantsRead;
    while (is_waiting(here) && there != TlsStep::kFailed) {
      here = client.handshake();
      if (is_waiting(there)) there = server.handshake();
    }
    return here == TlsStep::kDone && there == TlsStep::kDone;
  }

  const test::TemporaryFolder folder_;
};

TEST_F(TlsPair, ClientReportsTheFaultOfACertificate) {
  test::certify(folder_ / "old", {.begins_s = -2 * test::kDayS, .ends_s = -test::kDayS});
  test::certify(folder_ / "next", {.begins_s = test::kDayS, .ends_s = 2 * test::kDayS});
  test::certify(folder_ / "other", {.names = "DNS:other.example"});
  struct Case {
    const char *certificate, *authority, *host, *reason;
  };
  for (const Case& one :
       {Case{"good", "good", "127.0.0.1", ""}, Case{"good", "good", "localhost", ""},
        Case{"old", "old", "localhost", "has expired"},
        Case{"next", "next", "localhost", "is not valid yet"},
        Case{"other", "other", "127.0.0.1", "is not for 127.0.0.1"},
        Case{"other", "other", "localhost", "is not for localhost"},
        Case{"good", "other", "localhost", "unknown authority"}}) {
    std::array<int, 2> ends{};
    ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
    TlsChannel there(server(one.certificate), ends[0]);
    TlsChannel here(client(one.authority), ends[1], one.host);
    EXPECT_EQ(shake(there, here), *one.reason == '\0') << one.certificate << " " << one.host;
    EXPECT_TRUE(here.failure().contains(one.reason)) << here.failure();
    EXPECT_EQ(here.is_final(), *one.reason != '\0') << here.failure();
    for (const int end : ends) close(end);
  }
}

TEST_F(TlsPair, VersionsBeforeTls13AreRejected) {
  TlsChannel there(server("good"), ends_[0]);
  const std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> rules(SSL_CTX_new(TLS_client_method()),
                                                                SSL_CTX_free);
  SSL_CTX_set_max_proto_version(rules.get(), TLS1_2_VERSION);
  const std::unique_ptr<SSL, decltype(&SSL_free)> old(SSL_new(rules.get()), SSL_free);
  SSL_set_fd(old.get(), ends_[1]);
  SSL_set_connect_state(old.get());
  ASSERT_EQ(fcntl(ends_[1], F_SETFL, O_NONBLOCK), 0);
  EXPECT_NE(SSL_do_handshake(old.get()), 1);
  EXPECT_EQ(there.handshake(), TlsStep::kFailed);
  EXPECT_EQ(there.failure(), "the peer does not speak TLS 1.3");
  EXPECT_NE(SSL_do_handshake(old.get()), 1);
  EXPECT_EQ(SSL_get_error(old.get(), -1), SSL_ERROR_SSL) << "and the client knows";
}

TEST_F(TlsPair, TcpEndWithoutTlsEndLosesNothing) {
  TlsChannel there(server("good"), ends_[0]);
  TlsChannel here(client("good"), ends_[1], "localhost");
  ASSERT_TRUE(shake(there, here));
  constexpr std::size_t kMessages = 50, kBytes = 100;
  const std::vector<std::byte> message(kBytes, std::byte{7});
  for (std::size_t n = 0; n < kMessages; ++n) {
    std::size_t count = 0;
    ASSERT_EQ(here.write(message, count), TlsStep::kDone);
    ASSERT_EQ(count, kBytes);
  }
  ASSERT_EQ(shutdown(ends_[1], SHUT_WR), 0);
  std::array<std::byte, 1000> read{};
  std::size_t all = 0, count = 0;
  TlsStep step = TlsStep::kDone;
  while ((step = there.read(read, count)) == TlsStep::kDone) all += count;
  EXPECT_EQ(step, TlsStep::kClosed) << there.failure();
  EXPECT_EQ(all, kMessages * kBytes);
}

TEST_F(TlsTest, FilesThatCannotBeUsedAreNamed) {
  const auto error =
      test::error_of(TlsContext::of_server("/no/such/chain.pem", "/no/such/key.pem"));
  EXPECT_NE(error.find("/no/such/chain.pem"), std::string::npos);
  EXPECT_NE(error.find("No such file"), std::string::npos) << error;
  const auto client = test::error_of(TlsContext::of_client("/no/such/authority.pem"));
  EXPECT_NE(client.find("/no/such/authority.pem"), std::string::npos);
}

TEST(TlsCertificate, InvalidDatesAreReported) {
  constexpr long kDay = test::kDayS;
  const test::TemporaryFolder folder;
  const auto load = [&](const char* name, long begins_s, long ends_s) {
    test::certify(folder / name, {.begins_s = begins_s, .ends_s = ends_s});
    auto loaded = TlsCertificate::load(folder / (std::string(name) + ".pem"),
                                       folder / (std::string(name) + ".key"));
    EXPECT_TRUE(loaded) << loaded.error();
    return *std::move(loaded);
  };
  const auto good = load("good", -kDay, kDay);
  EXPECT_FALSE(good->fault());
  EXPECT_TRUE(load("old", -2 * kDay, -kDay)->fault()->contains("has expired"));
  EXPECT_TRUE(load("next", kDay, 2 * kDay)->fault()->contains("is not valid yet"));
  const std::string fault = *load("old", -2 * kDay, -kDay)->fault();
  EXPECT_TRUE(fault.contains("old.pem")) << fault;
  EXPECT_TRUE(std::regex_search(
      fault, std::regex("from 20..-..-.. ..:..:.. UTC to 20..-..-.. ..:..:.. UTC")))
      << fault;
  // Neither replaces a valid one.
  const std::int64_t expires_s = good->current().expires_s();
  for (const auto& [begins_s, ends_s] : {std::pair(-2 * kDay, -kDay), std::pair(kDay, 2 * kDay)}) {
    test::certify(folder / "good", {.begins_s = begins_s, .ends_s = ends_s});
    EXPECT_FALSE(good->reload());
    EXPECT_EQ(good->current().expires_s(), expires_s);
  }
  test::certify(folder / "good", {.ends_s = 3 * kDay});
  EXPECT_TRUE(good->reload());
  EXPECT_GT(good->current().expires_s(), expires_s);
}

TEST(TlsCertificate, OldCertificateStaysWhileTheNextIsUnusable) {
  const test::TemporaryFolder folder;
  test::certify(folder / "first");
  test::certify(folder / "next", {.ends_s = 2 * test::kDayS});
  test::certify(folder / "locked", {.ends_s = 2 * test::kDayS, .password = "secret"});
  std::ofstream(folder / "text.pem") << "no certificate\n";
  const auto install = [&](const char* name, const char* to) {
    constexpr auto kReplace = std::filesystem::copy_options::overwrite_existing;
    std::filesystem::copy_file(folder / name, folder / to, kReplace);
  };
  install("first.pem", "used.pem");
  install("first.key", "used.key");
  const auto used = TlsCertificate::load(folder / "used.pem", folder / "used.key").value();
  const std::int64_t expires_s = used->current().expires_s();
  for (const auto& [certificate, key, reason] :
       {std::tuple("text.pem", "first.key", "no start line"),
        std::tuple("next.pem", "first.key", "mismatch"),
        std::tuple("locked.pem", "locked.key", "it needs a password; store it without one")}) {
    install(certificate, "used.pem");
    install(key, "used.key");
    const auto reloaded = used->reload();
    ASSERT_FALSE(reloaded) << reason;
    EXPECT_TRUE(reloaded.error().contains(reason)) << reloaded.error();
    EXPECT_EQ(used->current().expires_s(), expires_s);
  }
  install("next.pem", "used.pem");
  install("next.key", "used.key");
  EXPECT_TRUE(used->reload());
  EXPECT_GT(used->current().expires_s(), expires_s);
}

}  // namespace
}  // namespace kerf::net::tls_test
