// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arpa/inet.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <string>

#include "tests/support/temporary_folder.h"

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

/// A nats-server of Debian's package with its own store, started and killed by tests.
class NatsProcess {
 public:
  static constexpr const char* kProgram = "/usr/sbin/nats-server";
  NatsProcess() = default;
  NatsProcess(const NatsProcess&) = delete;
  NatsProcess& operator=(const NatsProcess&) = delete;
  ~NatsProcess() { stop(); }

  static bool is_installed() { return access(kProgram, X_OK) == 0; }
  std::string url() const { return "nats://127.0.0.1:" + port_; }
  /// Returns whether it could be started.
  bool start() {
    const std::string store = folder_.path();
    std::array<const char*, 9> words = {kProgram,    "-js", "-sd",         store.c_str(), "-a",
                                        "127.0.0.1", "-p",  port_.c_str(), nullptr};
    posix_spawn_file_actions_t silent;
    posix_spawn_file_actions_init(&silent);
    posix_spawn_file_actions_addopen(&silent, STDERR_FILENO, "/dev/null", 1, 0);
    const int failed = posix_spawn(&process_, kProgram, &silent, nullptr,
                                   const_cast<char* const*>(words.data()), environ);
    posix_spawn_file_actions_destroy(&silent);
    if (failed != 0) process_ = 0;
    return failed == 0;
  }
  /// Stops it from answering until resume().
  void suspend() const { kill(process_, SIGSTOP); }
  void resume() const { kill(process_, SIGCONT); }
  void stop() {
    if (process_ == 0) return;
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
    process_ = 0;
  }

 private:
  const TemporaryFolder folder_;
  const std::string port_ = std::to_string(free_port());
  pid_t process_ = 0;
};

}  // namespace kerf::test
