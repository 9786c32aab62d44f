// SPDX-License-Identifier: Apache-2.0
// TLS against peers that do not speak it; tests/server/live_tls_test.py has those that do.
#include <gtest/gtest.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <memory>
#include <regex>
#include <string_view>

#include "server/tls/tls_channel.h"
#include "server/tls/tls_context.h"
#include "tests/server/temporary_folder.h"

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

/// Writes PATH.pem and PATH.key: a certificate of its own, valid between times from now on, s.
void certify(const std::filesystem::path& path, long begins_s, long ends_s) {
  const std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)> key(EVP_EC_gen("P-256"), EVP_PKEY_free);
  const std::unique_ptr<X509, decltype(&X509_free)> own(X509_new(), X509_free);
  ASSERT_TRUE(key && own);
  ASN1_INTEGER_set(X509_get_serialNumber(own.get()), 1);
  X509_gmtime_adj(X509_getm_notBefore(own.get()), begins_s);
  X509_gmtime_adj(X509_getm_notAfter(own.get()), ends_s);
  X509_set_pubkey(own.get(), key.get());
  ASSERT_GT(X509_sign(own.get(), key.get(), EVP_sha256()), 0);
  const auto write = [&](const char* extension, auto&& put) {
    const std::unique_ptr<FILE, int (*)(FILE*)> file(
        std::fopen((path.string() + extension).c_str(), "w"), std::fclose);
    ASSERT_TRUE(file);
    EXPECT_EQ(put(file.get()), 1);
  };
  write(".pem", [&](FILE* file) { return PEM_write_X509(file, own.get()); });
  write(".key", [&](FILE* file) {
    return PEM_write_PrivateKey(file, key.get(), nullptr, nullptr, 0, nullptr, nullptr);
  });
}

TEST(TlsCertificate, OneThatIsNotValidNowIsNamedWithItsDates) {
  constexpr long kDay = 86'400;
  const test::TemporaryFolder folder;
  const auto load = [&](const char* name, long begins_s, long ends_s) {
    certify(folder / name, begins_s, ends_s);
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
  // Neither takes the place of one that is valid.
  const std::int64_t expires_s = good->current().expires_s();
  for (const auto& [begins_s, ends_s] : {std::pair(-2 * kDay, -kDay), std::pair(kDay, 2 * kDay)}) {
    certify(folder / "good", begins_s, ends_s);
    EXPECT_FALSE(good->reload());
    EXPECT_EQ(good->current().expires_s(), expires_s);
  }
  certify(folder / "good", -kDay, 3 * kDay);
  EXPECT_TRUE(good->reload());
  EXPECT_GT(good->current().expires_s(), expires_s);
}

}  // namespace
}  // namespace kerf::net
