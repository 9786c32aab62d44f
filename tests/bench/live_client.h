// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

extern char** environ;

namespace kerf::bench {

/// Raises the limit of open files of this process, and of the servers that it starts, to its
/// maximum.
inline void allow_many_files() {
  rlimit files{};
  getrlimit(RLIMIT_NOFILE, &files);
  files.rlim_cur = files.rlim_max;
  setrlimit(RLIMIT_NOFILE, &files);
}

using Clock = std::chrono::steady_clock;

[[noreturn]] inline void fail(const std::string& what) {
  std::fprintf(stderr, "%s\n", what.c_str());
  std::exit(1);
}

/// CPU time of a process, user and system, s.
inline double process_cpu_seconds(pid_t pid) {
  std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
  std::string line;
  std::getline(stat, line);
  // The fields behind the name in parentheses; utime and stime are the 14th and 15th of all.
  const std::string rest = line.substr(line.rfind(')') + 2);
  std::istringstream fields(rest);
  std::string skipped;
  for (int n = 3; n < 14; ++n) fields >> skipped;
  double user = 0, system = 0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

/// The server as a child process with its own data folder.
class ServerProcess {
 public:
  /// `options` are additional arguments of the command line.
  explicit ServerProcess(std::string program, std::vector<std::string> options = {})
      : program_(std::move(program)), options_(std::move(options)) {
    std::string name = (std::filesystem::temp_directory_path() / "kerf-bench-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    start();
  }
  ~ServerProcess() {
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
    std::filesystem::remove_all(folder_);
  }
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;
  /// Kills the process, which cannot write anything.
  void kill_hard() const {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  /// Starts the process, on the same port as before, and returns when it listens.
  void start() {
    std::array<int, 2> out{};
    if (pipe(out.data()) != 0) fail("no pipe");
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
    posix_spawn_file_actions_addclose(&actions, out[0]);
    const std::string data = folder_.string();
    const std::string address = "127.0.0.1:" + std::to_string(port_);
    std::vector<std::string> words = {program_, "--listen", address, "--data", data};
    words.insert(words.end(), options_.begin(), options_.end());
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    if (posix_spawn(&pid_, program_.c_str(), &actions, nullptr, arguments.data(), environ) != 0) {
      fail("cannot start " + program_);
    }
    posix_spawn_file_actions_destroy(&actions);
    close(out[1]);
    std::array<char, 256> line{};
    const ssize_t count = read(out[0], line.data(), line.size() - 1);
    close(out[0]);
    const char* colon = count > 0 ? std::strrchr(line.data(), ':') : nullptr;
    if (colon == nullptr) fail("the server did not print its address");
    port_ = static_cast<std::uint16_t>(std::atoi(colon + 1));
  }
  const std::filesystem::path& folder() const { return folder_; }
  std::uint16_t port() const { return port_; }
  /// SIGSTOP, SIGCONT, SIGKILL.
  void signal(int number) const { kill(pid_, number); }
  pid_t pid() const { return pid_; }
  /// CPU time of the server, user and system, s.
  double cpu_seconds() const { return process_cpu_seconds(pid_); }
  /// Resident memory of the server, MB: present and greatest.
  double memory_mb() const { return status_mb("VmRSS:"); }
  double peak_memory_mb() const { return status_mb("VmHWM:"); }

 private:
  double status_mb(std::string_view field) const {
    std::ifstream status("/proc/" + std::to_string(pid_) + "/status");
    for (std::string line; std::getline(status, line);) {
      if (line.starts_with(field)) return std::atof(line.c_str() + field.size()) / 1024;
    }
    return 0;
  }

  std::string program_;
  std::vector<std::string> options_;
  std::filesystem::path folder_;
  pid_t pid_ = 0;
  std::uint16_t port_ = 0;
};

class Socket {
 public:
  explicit Socket(std::uint16_t port) : descriptor_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (connect(descriptor_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
      fail("cannot connect");
    }
    const int on = 1;
    setsockopt(descriptor_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  }
  ~Socket() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  Socket(Socket&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;

  int descriptor() const { return descriptor_; }

  void send_all(const void* data, std::size_t size) const {
    if (!try_send_all(data, size, -1)) fail("the connection broke");
  }
  /// Returns false if the peer has closed the connection or accepts nothing for `wait_ms`
  /// (negative: no limit).
  bool try_send_all(const void* data, std::size_t size, int wait_ms) const {
    const auto* bytes = static_cast<const char*>(data);
    while (size > 0) {
      pollfd events{descriptor_, POLLOUT, 0};
      if (poll(&events, 1, wait_ms) <= 0) return false;
      const ssize_t sent = ::send(descriptor_, bytes, size, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (sent < 0 && errno == EAGAIN) continue;
      if (sent <= 0) return false;
      bytes += sent;
      size -= static_cast<std::size_t>(sent);
    }
    return true;
  }
  /// Appends received bytes to `buffer`. Returns false if none arrive until `until`.
  bool receive(std::string& buffer, Clock::time_point until) const {
    const auto wait = std::chrono::ceil<std::chrono::nanoseconds>(until - Clock::now()).count();
    const timespec limit{wait > 0 ? wait / 1'000'000'000 : 0, wait > 0 ? wait % 1'000'000'000 : 0};
    pollfd events{descriptor_, POLLIN, 0};
    if (ppoll(&events, 1, &limit, nullptr) <= 0) return false;
    std::array<char, 16384> chunk{};
    const ssize_t count = recv(descriptor_, chunk.data(), chunk.size(), 0);
    if (count <= 0) fail("the server closed the connection");
    buffer.append(chunk.data(), static_cast<std::size_t>(count));
    return true;
  }

 private:
  int descriptor_;
};

inline Clock::time_point in_seconds(double seconds) {
  return Clock::now() + std::chrono::microseconds(static_cast<std::int64_t>(seconds * 1e6));
}

inline void post(std::uint16_t port, const std::string& path, const std::string& body) {
  const Socket socket(port);
  const std::string request = "POST " + path +
                              " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" +
                              "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
  socket.send_all(request.data(), request.size());
  std::string answer;
  while (answer.find("\r\n") == std::string::npos) socket.receive(answer, in_seconds(60));
  if (answer.compare(9, 2, "20") != 0) fail(path + ": " + answer);
}

/// Returns the body of the answer to a GET request.
inline std::string get(std::uint16_t port, const std::string& path) {
  const Socket socket(port);
  const std::string request =
      "GET " + path + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
  socket.send_all(request.data(), request.size());
  std::string answer;
  for (;;) {
    const std::size_t head = answer.find("\r\n\r\n");
    const std::size_t length = answer.find("Content-Length: ");
    if (head != std::string::npos && length < head) {
      const auto bytes = std::strtoull(answer.c_str() + length + 16, nullptr, 10);
      if (answer.size() >= head + 4 + bytes) return answer.substr(head + 4, bytes);
    }
    if (!socket.receive(answer, in_seconds(60))) fail("no answer: " + path);
  }
}

/// Returns the first value of this name in a JSON text, unless it is a list or object.
inline std::string json_field(const std::string& json, const std::string& name) {
  const std::size_t at = json.find("\"" + name + "\":");
  if (at == std::string::npos) fail("no " + name + " in " + json);
  const std::size_t start = json.find_first_not_of(" \"", at + name.size() + 3);
  return json.substr(start, json.find_first_of(",\"}", start) - start);
}

inline std::string upgrade_request(const std::string& path, const std::string& protocol) {
  return "GET " + path +
         " HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n" +
         "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Version: 13\r\n" +
         "Sec-WebSocket-Protocol: " + protocol + "\r\n\r\n";
}

/// The parts of a WebSocket client that the benchmarks need.
class WebSocket {
 public:
  WebSocket(std::uint16_t port, const std::string& path, const std::string& protocol)
      : socket_(port) {
    const std::string request = upgrade_request(path, protocol);
    socket_.send_all(request.data(), request.size());
    std::size_t end = 0;
    while ((end = buffer_.find("\r\n\r\n")) == std::string::npos) {
      socket_.receive(buffer_, in_seconds(10));
    }
    if (buffer_.compare(9, 3, "101") != 0) fail(buffer_);
    buffer_.erase(0, end + 4);
  }
  /// Sends with a mask of zero, which is legal and leaves the payload unchanged.
  void send(unsigned char opcode, std::span<const std::byte> payload) {
    if (!put(opcode, payload, -1)) fail("the connection broke");
  }
  /// Returns false if the server has closed the connection or accepts nothing for a second.
  bool try_send(unsigned char opcode, std::span<const std::byte> payload) {
    return put(opcode, payload, 1000);
  }
  /// Returns the opcode of the next frame and its payload, or 0 if none is complete by `until`.
  unsigned char receive(std::string& payload, Clock::time_point until) {
    for (;;) {
      if (const auto opcode = take(payload); opcode != 0) return opcode;
      if (!socket_.receive(buffer_, until)) return 0;
    }
  }

 private:
  bool put(unsigned char opcode, std::span<const std::byte> payload, int wait_ms) {
    frame_.assign(1, static_cast<char>(0x80 | opcode));
    if (payload.size() < 126) {
      frame_.push_back(static_cast<char>(0x80 | payload.size()));
    } else {
      frame_.push_back(static_cast<char>(0x80 | 126));
      frame_.push_back(static_cast<char>(payload.size() >> 8));
      frame_.push_back(static_cast<char>(payload.size() & 0xFF));
    }
    frame_.append(4, '\0');
    frame_.append(reinterpret_cast<const char*>(payload.data()), payload.size());
    return socket_.try_send_all(frame_.data(), frame_.size(), wait_ms);
  }
  unsigned char take(std::string& payload) {
    const auto at = [&](std::size_t i) { return static_cast<unsigned char>(buffer_[i]); };
    if (buffer_.size() < 2) return 0;
    std::size_t head = 2, size = at(1) & 0x7FU;
    if (size >= 126) {
      const std::size_t end = size == 126 ? 4 : 10;
      if (buffer_.size() < end) return 0;
      for (size = 0; head < end; ++head) size = size << 8 | at(head);
    }
    if (buffer_.size() < head + size) return 0;
    const auto opcode = static_cast<unsigned char>(at(0) & 0x0FU);
    payload = buffer_.substr(head, size);
    buffer_.erase(0, head + size);
    return opcode;
  }

  Socket socket_;
  std::string buffer_, frame_;
};

}  // namespace kerf::bench
