// SPDX-License-Identifier: Apache-2.0
// TLS of a whole server: reports about its certificate, and downloads by slow clients.
#include <netinet/in.h>
#include <openssl/ssl.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/certificate.h"
#include "server/log/log.h"
#include "server/metrics/metrics.h"
#include "server/server.h"
#include "tests/server/certificates.h"
#include "tests/server/session_fixture.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::net::server_tls_test {
namespace {

class CertificateReport : public SessionTest {
 protected:
  /// Loads a certificate like a server at its start. Returns the log.
  std::string log_of(const char* name, const test::Certified& words) {
    test::certify(folder / name, words);
    const std::string path = folder / name;
    testing::internal::CaptureStderr();
    log::open();
    auto loaded = load_certificate(path + ".pem", path + ".key");
    const std::string text = testing::internal::GetCapturedStderr();
    log::open();
    EXPECT_TRUE(loaded) << loaded.error();
    show_expiry(loaded->get(), metrics);
    return text;
  }
  double days_left() {
    const std::string text = metrics.text(*registry), name = "\nkerf_certificate_days_left ";
    return std::stod(text.substr(text.find(name) + name.size()));
  }

  Metrics metrics;
};

TEST_F(CertificateReport, ExpiredCertificateIsReportedAndCounted) {
  const std::string text = log_of("old", {.begins_s = -2 * test::kDayS, .ends_s = -test::kDayS});
  EXPECT_TRUE(text.contains("old.pem has expired")) << text;
  EXPECT_TRUE(text.contains("SIGHUP")) << text;
  EXPECT_LT(days_left(), 0);
  EXPECT_EQ(log_of("good", {}), "");
  EXPECT_GT(days_left(), 0);
}

/// A client over TLS that reads only as much as the test asks for.
class SlowReader {
 public:
  explicit SlowReader(std::uint16_t port)
      : rules_(SSL_CTX_new(TLS_client_method()), SSL_CTX_free),
        ssl_(SSL_new(rules_.get()), SSL_free),
        socket_(socket(AF_INET, SOCK_STREAM, 0)) {
    const int few = 4096;
    setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &few, sizeof few);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    SSL_set_fd(ssl_.get(), socket_);
    EXPECT_EQ(SSL_connect(ssl_.get()), 1);
  }
  ~SlowReader() { close(socket_); }
  SlowReader(const SlowReader&) = delete;
  SlowReader& operator=(const SlowReader&) = delete;
  /// Sends a request and returns the beginning of the answer.
  std::string ask(const std::string& target) {
    std::string request = "GET ";
    request.append(target).append(" HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_EQ(SSL_write(ssl_.get(), request.data(), static_cast<int>(request.size())),
              static_cast<int>(request.size()));
    std::string answer(2048, '\0');
    const int count = SSL_read(ssl_.get(), answer.data(), static_cast<int>(answer.size()));
    answer.resize(static_cast<std::size_t>(std::max(count, 0)));
    return answer;
  }

 private:
  std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> rules_;
  std::unique_ptr<SSL, decltype(&SSL_free)> ssl_;
  int socket_;
};

std::size_t resident_bytes() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages >> pages;
  return pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

TEST(SlowDownloads, OverTlsUseLittleMemory) {
  constexpr std::size_t kBytes = std::size_t{8} << 20, kReaders = 20;
  const test::TemporaryFolder folder;
  test::certify(folder / "own");
  std::filesystem::create_directory(folder / "web");
  std::ofstream(folder / "web/large.bin") << std::string(kBytes, 'x');
  ServerOptions options{.port = 0,
                        .http = {.data_folder = folder / "data", .web_folder = folder / "web"},
                        .udp = {.on = false},
                        .tls_certificate = folder / "own.pem",
                        .tls_key = folder / "own.key"};
  auto server = Server::create(options).value();
  ASSERT_TRUE(server->listen());
  std::vector<std::unique_ptr<SlowReader>> readers;
  const std::size_t before = resident_bytes();
  for (std::size_t n = 0; n < kReaders; ++n) {
    readers.push_back(std::make_unique<SlowReader>(server->port()));
    const std::string head = readers.back()->ask("/large.bin");
    EXPECT_TRUE(head.starts_with("HTTP/1.1 200 ")) << head.substr(0, 200);
    EXPECT_TRUE(head.contains("Content-Length: " + std::to_string(kBytes))) << head.substr(0, 500);
  }
  EXPECT_LT(resident_bytes(), before + kReaders * kBytes / 4);
}

}  // namespace
}  // namespace kerf::net::server_tls_test
