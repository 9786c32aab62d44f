// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <optional>
#include <string>

#include "server/cluster/nats_connection.h"
#include "tests/server/temporary_folder.h"

namespace kerf::test {

inline int free_port() {
  const int probe = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  bind(probe, reinterpret_cast<sockaddr*>(&address), size);
  getsockname(probe, reinterpret_cast<sockaddr*>(&address), &size);
  close(probe);
  return ntohs(address.sin_port);
}

/// A real nats-server and a connection to it; its tests are skipped where there is none.
class NatsTest : public testing::Test {
 protected:
  void SetUp() override {
    const char* program = "/usr/sbin/nats-server";
    if (access(program, X_OK) != 0) GTEST_SKIP() << "nats-server is not installed";
    const std::string port = std::to_string(free_port()), store = folder_.path();
    std::array<const char*, 9> words = {program,     "-js", "-sd",        store.c_str(), "-a",
                                        "127.0.0.1", "-p",  port.c_str(), nullptr};
    posix_spawn_file_actions_t silent;
    posix_spawn_file_actions_init(&silent);
    posix_spawn_file_actions_addopen(&silent, STDERR_FILENO, "/dev/null", 1, 0);
    ASSERT_EQ(posix_spawn(&process_, program, &silent, nullptr,
                          const_cast<char* const*>(words.data()), environ),
              0);
    posix_spawn_file_actions_destroy(&silent);
    auto nats = NatsConnection::open("nats://127.0.0.1:" + port, "test");
    ASSERT_TRUE(nats && nats->is_connected());
    nats_.emplace(*std::move(nats));
  }
  void TearDown() override {
    nats_.reset();
    if (process_ == 0) return;
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }

  const TemporaryFolder folder_;
  pid_t process_ = 0;
  std::optional<NatsConnection> nats_;
};

}  // namespace kerf::test
