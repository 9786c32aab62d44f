// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/lossy_path.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <new>
#include <random>
#include <utility>
#include <vector>

namespace kerf::bench {
namespace {

using Clock = std::chrono::steady_clock;

int checked(int result, const char* what) {
  if (result >= 0) return result;
  std::fprintf(stderr, "cannot create a lossy network path: %s: %s\n", what, std::strerror(errno));
  std::exit(1);
}

void set(int socket, unsigned long request, const ifreq& value, const char* what) {
  checked(::ioctl(socket, request, &value), what);
}

/// Creates a TUN device in the current namespace with its address and its peer's, and activates it.
/// Returns its descriptor.
int tun(const char* own, const char* peer) {
  const int device = checked(::open("/dev/net/tun", O_RDWR | O_NONBLOCK), "/dev/net/tun");
  ifreq request{};
  request.ifr_flags = IFF_TUN | IFF_NO_PI;
  checked(::ioctl(device, TUNSETIFF, &request), "TUNSETIFF");
  const int socket = checked(::socket(AF_INET, SOCK_DGRAM, 0), "socket");
  const auto address = [&](const char* text) {
    ifreq named = request;
    sockaddr_in in{};
    in.sin_family = AF_INET;
    inet_pton(AF_INET, text, &in.sin_addr);
    std::memcpy(&named.ifr_addr, &in, sizeof in);
    return named;
  };
  set(socket, SIOCSIFADDR, address(own), "SIOCSIFADDR");
  set(socket, SIOCSIFDSTADDR, address(peer), "SIOCSIFDSTADDR");
  request.ifr_flags = IFF_UP | IFF_RUNNING;
  set(socket, SIOCSIFFLAGS, request, "SIOCSIFFLAGS");
  ::close(socket);
  return device;
}

void enter_namespace() {
  if (::unshare(CLONE_NEWNET) == 0) return;
  const uid_t user = ::getuid();
  checked(::unshare(CLONE_NEWUSER | CLONE_NEWNET), "unshare");
  std::ofstream("/proc/self/uid_map") << "0 " << user << " 1";
}

/// Forwards packets between the two devices until the process is killed.
[[noreturn]] void forward(int here, int there, PathFaults& faults) {
  std::mt19937_64 random(83);
  std::uniform_real_distribution<double> share(0, 1);
  std::multimap<Clock::time_point, std::pair<int, std::vector<char>>> in_flight;
  const auto read_all = [&](int from, int to) {
    std::array<char, 2048> packet;
    ssize_t count = 0;
    while ((count = ::read(from, packet.data(), packet.size())) > 0) {
      ++faults.packets;
      if (share(random) < faults.loss) {
        ++faults.lost;
        continue;
      }
      in_flight.emplace(Clock::now() + std::chrono::microseconds(faults.delay_us),
                        std::pair{to, std::vector<char>(packet.data(), packet.data() + count)});
    }
  };
  for (;;) {
    constexpr long kLongestNs = 100'000'000;
    const long wait_ns =
        in_flight.empty()
            ? kLongestNs
            : std::clamp(std::chrono::nanoseconds(in_flight.begin()->first - Clock::now()).count(),
                         0L, kLongestNs);
    const timespec wait{0, wait_ns};
    std::array<pollfd, 2> events{pollfd{here, POLLIN, 0}, pollfd{there, POLLIN, 0}};
    ::ppoll(events.data(), events.size(), &wait, nullptr);
    read_all(here, there);
    read_all(there, here);
    while (!in_flight.empty() && in_flight.begin()->first <= Clock::now()) {
      const auto& [to, packet] = in_flight.begin()->second;
      // A device whose queue is full drops the packet, like a router.
      [[maybe_unused]] const auto written = ::write(to, packet.data(), packet.size());
      in_flight.erase(in_flight.begin());
    }
  }
}

}  // namespace

LossyPath::LossyPath() {
  void* shared = ::mmap(nullptr, sizeof(PathFaults), PROT_READ | PROT_WRITE,
                        MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) checked(-1, "mmap");
  faults_ = new (shared) PathFaults;
  enter_namespace();
  here_ = tun(kHere, kThere);
}

void LossyPath::start(const std::string& command) {
  std::fflush(nullptr);
  forwarder_ = checked(::fork(), "fork");
  if (forwarder_ != 0) return;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  checked(::unshare(CLONE_NEWNET), "unshare");
  const int there = tun(kThere, kHere);
  if (checked(::fork(), "fork") == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    const int nowhere = ::open("/dev/null", O_WRONLY);
    ::dup2(nowhere, STDOUT_FILENO);
    ::execl("/bin/sh", "sh", "-c", ("exec " + command).c_str(), nullptr);
    ::_exit(127);
  }
  forward(here_, there, *faults_);
}

LossyPath::~LossyPath() {
  if (forwarder_ > 0) {
    ::kill(forwarder_, SIGKILL);
    ::waitpid(forwarder_, nullptr, 0);
  }
  ::close(here_);
}

}  // namespace kerf::bench
