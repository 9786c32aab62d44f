// SPDX-License-Identifier: Apache-2.0
#include "tests/agent/link/lossy_line.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <vector>

namespace kerf::agent {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::microseconds;

constexpr microseconds kOvertaken{5000};

sockaddr_in address(const char* host, std::uint16_t port) {
  sockaddr_in in{};
  in.sin_family = AF_INET;
  in.sin_port = htons(port);
  inet_pton(AF_INET, host, &in.sin_addr);
  return in;
}

int checked(int result, const char* what) {
  if (result < 0) {
    std::perror(what);
    std::abort();
  }
  return result;
}

int bound(int kind, const char* host, std::uint16_t port) {
  const int socket = checked(::socket(AF_INET, kind | SOCK_NONBLOCK | SOCK_CLOEXEC, 0), "socket");
  const int on = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  const sockaddr_in here = address(host, port);
  checked(::bind(socket, reinterpret_cast<const sockaddr*>(&here), sizeof here), "bind");
  return socket;
}

int connected(int kind, std::uint16_t port) {
  const int socket = checked(::socket(AF_INET, kind | SOCK_CLOEXEC, 0), "socket");
  const sockaddr_in there = address("127.0.0.1", port);
  checked(::connect(socket, reinterpret_cast<const sockaddr*>(&there), sizeof there), "connect");
  return socket;
}

/// Bytes in flight to a socket. Empty for the end of the connection.
struct Parcel {
  int to = -1;
  sockaddr_in address{};  ///< address of the agent; unused for datagrams to the server, whose
                          ///< socket is connected
  bool named = false;
  std::string bytes;
};

struct TcpEnd {
  int other = -1;
  Clock::time_point last;  ///< arrival time of the last bytes sent
};

}  // namespace

class LossyLine::Impl {
 public:
  Impl(std::uint16_t tcp_port, std::uint16_t udp_port, LineFaults faults)
      : faults_(faults),
        tcp_port_(tcp_port),
        udp_port_(udp_port),
        random_(faults.seed),
        listener_(bound(SOCK_STREAM, kHost, tcp_port)),
        front_(bound(SOCK_DGRAM, kHost, udp_port)) {
    checked(::listen(listener_, 16), "listen");
    thread_ = std::thread([this] { run(); });
  }

  ~Impl() {
    stop_ = true;
    thread_.join();
    for (const auto& [socket, end] : tcp_) ::close(socket);
    for (const int socket : ended_) ::close(socket);
    for (const auto& [socket, agent] : backs_) ::close(socket);
    ::close(listener_);
    ::close(front_);
  }

  std::atomic<bool> blocked{false}, rebind{false};
  LineCounts counts() const {
    const std::scoped_lock lock(mutex_);
    return counts_;
  }

 private:
  bool happens(double share) {
    return std::uniform_real_distribution<double>(0, 1)(random_) < share;
  }

  void run() {
    while (!stop_) {
      if (rebind.exchange(false)) forget_backs();
      deliver();
      std::vector<pollfd> events = {{listener_, POLLIN, 0}, {front_, POLLIN, 0}};
      for (const auto& [socket, end] : tcp_) events.push_back({socket, POLLIN, 0});
      for (const auto& [socket, agent] : backs_) events.push_back({socket, POLLIN, 0});
      constexpr long kLongestNs = 5'000'000;
      const long wait_ns =
          in_flight_.empty()
              ? kLongestNs
              : std::clamp(
                    std::chrono::nanoseconds(in_flight_.begin()->first - Clock::now()).count(), 0L,
                    kLongestNs);
      const timespec wait{0, wait_ns};
      ::ppoll(events.data(), events.size(), &wait, nullptr);
      for (const pollfd& event : events) {
        if (event.revents != 0) read(event.fd);
      }
    }
  }

  void read(int socket) {
    if (socket == listener_) return accept();
    if (tcp_.contains(socket)) return read_tcp(socket);
    while (read_datagram(socket)) {
    }
  }

  void accept() {
    const int agent = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
    if (agent < 0) return;
    const int server = connected(SOCK_STREAM, tcp_port_);
    const int on = 1;
    for (const int socket : {agent, server}) {
      ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    }
    tcp_[agent] = {server, Clock::now()};
    tcp_[server] = {agent, Clock::now()};
  }

  void read_tcp(int socket) {
    TcpEnd& end = tcp_[socket];
    std::string bytes(1 << 16, '\0');
    const ssize_t count = ::recv(socket, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (count < 0 && errno == EAGAIN) return;
    bytes.resize(count > 0 ? static_cast<std::size_t>(count) : 0);
    end.last = std::max(end.last, Clock::now() + faults_.delay + faults_.tcp_delay);
    const int to = end.other;
    const auto at = end.last;
    if (count <= 0) {  // end of the stream
      tcp_.erase(socket);
      ::shutdown(socket, SHUT_RD);
      ended_.push_back(socket);
    }
    in_flight_.emplace(at, Parcel{.to = to, .bytes = std::move(bytes)});
  }

  bool read_datagram(int socket) {
    std::string bytes(2048, '\0');
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t count = ::recvfrom(socket, bytes.data(), bytes.size(), MSG_DONTWAIT,
                                     reinterpret_cast<sockaddr*>(&from), &size);
    if (count < 0) return false;
    bytes.resize(static_cast<std::size_t>(count));
    if (socket == front_) {
      pass({.to = back_of(from), .bytes = std::move(bytes)});
    } else {
      pass({.to = front_, .address = backs_[socket], .named = true, .bytes = std::move(bytes)});
    }
    return true;
  }

  int back_of(const sockaddr_in& agent) {
    for (const auto& [socket, known] : backs_) {
      if (known.sin_port == agent.sin_port && known.sin_addr.s_addr == agent.sin_addr.s_addr) {
        return socket;
      }
    }
    const int socket = connected(SOCK_DGRAM, udp_port_);
    backs_[socket] = agent;
    return socket;
  }

  void forget_backs() {
    for (const auto& [socket, agent] : backs_) ::close(socket);
    backs_.clear();
    std::erase_if(in_flight_, [](const auto& parcel) { return parcel.second.named; });
  }

  void pass(Parcel parcel) {
    const std::scoped_lock lock(mutex_);
    const auto number = static_cast<std::int64_t>(++counts_.datagrams);
    const bool in_burst = faults_.burst_every > 0 &&
                          number % faults_.burst_every >= faults_.burst_every - faults_.burst;
    if (blocked || in_burst || happens(faults_.loss)) {
      ++counts_.lost;
      return;
    }
    auto at = Clock::now() + faults_.delay;
    if (happens(faults_.reordering)) {
      at += kOvertaken;
      ++counts_.reordered;
    }
    if (happens(faults_.duplication)) {
      in_flight_.emplace(at + microseconds(300), parcel);
      ++counts_.duplicated;
    }
    in_flight_.emplace(at, std::move(parcel));
  }

  void deliver() {
    const auto now = Clock::now();
    while (!in_flight_.empty() && in_flight_.begin()->first <= now) {
      const Parcel parcel = std::move(in_flight_.begin()->second);
      in_flight_.erase(in_flight_.begin());
      if (parcel.named) {
        ::sendto(parcel.to, parcel.bytes.data(), parcel.bytes.size(), MSG_NOSIGNAL,
                 reinterpret_cast<const sockaddr*>(&parcel.address), sizeof parcel.address);
      } else if (parcel.bytes.empty()) {
        ::shutdown(parcel.to, SHUT_WR);
      } else {
        ::send(parcel.to, parcel.bytes.data(), parcel.bytes.size(), MSG_NOSIGNAL);
      }
    }
  }

  LineFaults faults_;
  std::uint16_t tcp_port_, udp_port_;
  std::mt19937_64 random_;
  int listener_, front_;
  std::map<int, TcpEnd> tcp_;
  std::vector<int> ended_;
  /// One socket to the server per agent.
  std::map<int, sockaddr_in> backs_;
  std::multimap<Clock::time_point, Parcel> in_flight_;
  std::atomic<bool> stop_{false};
  mutable std::mutex mutex_;
  LineCounts counts_;
  std::thread thread_;
};

LossyLine::LossyLine(std::uint16_t tcp_port, std::uint16_t udp_port, LineFaults faults)
    : impl_(std::make_unique<Impl>(tcp_port, udp_port, faults)) {}
LossyLine::~LossyLine() = default;
void LossyLine::block_udp(bool blocked) { impl_->blocked = blocked; }
void LossyLine::rebind() { impl_->rebind = true; }
LineCounts LossyLine::counts() const { return impl_->counts(); }

}  // namespace kerf::agent
