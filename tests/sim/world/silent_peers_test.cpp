// SPDX-License-Identifier: Apache-2.0
// The server closes the connections of silent peers in time, by its virtual clock.
#include <arpa/inet.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "server/log/log.h"
#include "tests/sim/world/http_client.h"
#include "tests/sim/world/scene.h"
#include "tests/sim/world/server_machine.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::sim::silent_peers_test {
namespace {

constexpr int kPort = 8080;
std::string upgrade(const std::string& kind) {
  return "GET /v1/sessions/block/" + kind +
         " HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
         "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n"
         "Sec-WebSocket-Protocol: kerf." +
         kind + ".v1\r\n\r\n";
}

/// The bytes received on a connection that sends only `bytes`, and the time of its end.
struct Silence {
  std::string received;
  Time length = 0;
};

Silence be_silent_after(const std::string& bytes) {
  const int file = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(kPort);
  if (connect(file, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) return {};
  const Time start = now();
  Silence silence;
  if (send(file, bytes.data(), bytes.size(), MSG_NOSIGNAL) < 0) return {};
  std::array<char, 4096> part{};
  while (now() < start + 60 * kSecond) {
    const ssize_t size = recv(file, part.data(), part.size(), 0);
    if (size > 0) silence.received.append(part.data(), static_cast<std::size_t>(size));
    if (size == 0 || (size < 0 && errno != EAGAIN && errno != EINTR)) break;
    pollfd wanted{file, POLLIN, 0};
    if (size < 0) poll(&wanted, 1, 1000);
  }
  silence.length = now() - start;
  close(file);
  return silence;
}

/// Writes a line for each peer.
void observe(std::ostream& out, const std::filesystem::path& folder) {
  net::ServerOptions options{.port = kPort, .udp = {.on = false}};
  ServerMachine server("server", options, folder / "server", 1);
  server.start();
  while (ask(kPort, "POST", "/v1/sessions?id=block", kScene).status != 201) {
    sleep_until(now() + 50 * kMillisecond);
  }
  const auto observe_one = [&](const char* name, const std::string& bytes) {
    const Silence silence = be_silent_after(bytes);
    const bool is_named = silence.received.find("\"no_hello\"") != std::string::npos &&
                          silence.received.find("\"fatal\":true") != std::string::npos;
    out << name << ": " << silence.length / kSecond << " s" << (is_named ? ", no hello" : "")
        << '\n';
  };
  observe_one("nothing", "");
  observe_one("half a header", "GET / HTTP/1.1\r\n");
  observe_one("an agent", upgrade("agent"));
  observe_one("a viewer", upgrade("view"));
  server.stop();
}

[[noreturn]] void live(const std::filesystem::path& folder) {
  const std::string log = folder / "log";
  dup2(open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600), STDERR_FILENO);
  log::open();
  std::ofstream out(folder / "seen");
  begin_turns({.seed = 1}, [&](const std::string& reason) { out << reason << std::endl; });
  observe(out, folder);
  out.flush();
  _exit(0);
}

// A header has 10 s, a hello 5 s, and a peer that does not close 1.5 s more.
TEST(SilentPeers, AreClosedInTime) {
  const test::TemporaryFolder folder;
  const pid_t child = fork();  // a simulation lasts as long as its process
  if (child == 0) live(folder.path());
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  const std::string text = test::content_of(folder / "seen");
  EXPECT_EQ(text,
            "nothing: 10 s\nhalf a header: 10 s\nan agent: 6 s, no hello\na viewer: 6 s, no "
            "hello\n");
}

}  // namespace
}  // namespace kerf::sim::silent_peers_test
