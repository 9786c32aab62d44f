// SPDX-License-Identifier: Apache-2.0
// TCP over the loopback of the simulation, and waits for descriptors. A TCP socket is a socket of
// the local domain: data arrives before the call that sends it returns, so that runs are equal.
// Addresses are ports only; all machines share them.
#include <dlfcn.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/timerfd.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <ctime>
#include <map>
#include <string>

#include "tests/sim/os/descriptors.h"
#include "tests/sim/os/task.h"

namespace {

using namespace kerf::sim;

template <typename Function>
Function real(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

sockaddr_un local_name(int port, socklen_t& size) {
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  const std::string text = "kerf-sim/" + std::to_string(getpid()) + "/" + std::to_string(port);
  std::memcpy(name.sun_path + 1, text.data(), text.size());  // abstract: it begins with 0
  size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + text.size());
  return name;
}

int port_of(const sockaddr* address) {
  if (address->sa_family == AF_INET6) {
    return ntohs(reinterpret_cast<const sockaddr_in6*>(address)->sin6_port);
  }
  return ntohs(reinterpret_cast<const sockaddr_in*>(address)->sin_port);
}

int put_address(int port, sockaddr* address, socklen_t* size) {
  if (address == nullptr) return 0;
  sockaddr_in shown{};
  shown.sin_family = AF_INET;
  shown.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  shown.sin_port = htons(static_cast<std::uint16_t>(port));
  std::memcpy(address, &shown, std::min<std::size_t>(*size, sizeof shown));
  *size = sizeof shown;
  return 0;
}

Descriptor* socket_of(int file) {
  return takes_turns() ? Descriptors::instance().find(file, Descriptor::Kind::kSocket) : nullptr;
}

/// Calls a function that sends or ends something that another thread may wait for.
template <typename Function, typename... Words>
auto then_wake(const char* name, Words... words) {
  const auto result = real<Function>(name)(words...);
  const int error = errno;
  if (takes_turns()) {
    note_input();
    may_switch();
  }
  errno = error;
  return result;
}

}  // namespace

extern "C" {

int socket(int domain, int type, int protocol) noexcept {
  static const auto call = real<int (*)(int, int, int)>("socket");
  const bool is_tcp = (domain == AF_INET || domain == AF_INET6) && (type & 0xf) == SOCK_STREAM;
  if (!takes_turns() || !is_tcp) return call(domain, type, protocol);
  const int file = call(AF_UNIX, type, 0);
  if (file >= 0) Descriptors::instance().add(file, Descriptor::Kind::kSocket);
  return file;
}

int bind(int file, const sockaddr* address, socklen_t size) noexcept {
  static const auto call = real<int (*)(int, const sockaddr*, socklen_t)>("bind");
  Descriptor* known = socket_of(file);
  if (known == nullptr) return call(file, address, size);
  known->port = port_of(address);
  if (known->port == 0) known->port = Descriptors::instance().next_port();
  socklen_t length = 0;
  const sockaddr_un name = local_name(known->port, length);
  return call(file, reinterpret_cast<const sockaddr*>(&name), length);
}

int connect(int file, const sockaddr* address, socklen_t size) {
  static const auto call = real<int (*)(int, const sockaddr*, socklen_t)>("connect");
  Descriptor* known = socket_of(file);
  if (known == nullptr) return call(file, address, size);
  known->peer = port_of(address);
  if (known->port == 0) known->port = Descriptors::instance().next_port();
  socklen_t length = 0;
  const sockaddr_un name = local_name(known->peer, length);
  const int failed = call(file, reinterpret_cast<const sockaddr*>(&name), length);
  const int error = errno;
  note_input();
  may_switch();
  errno = error;
  return failed;
}

int accept4(int file, sockaddr* address, socklen_t* size, int flags) {
  static const auto call = real<int (*)(int, sockaddr*, socklen_t*, int)>("accept4");
  Descriptor* known = socket_of(file);
  if (known == nullptr) return call(file, address, size, flags);
  const int port = known->port;
  const int taken = call(file, nullptr, nullptr, flags);
  if (taken < 0) return taken;
  auto& made = Descriptors::instance().add(taken, Descriptor::Kind::kSocket);
  made.port = port;
  made.peer = Descriptors::instance().next_port();
  put_address(made.peer, address, size);
  return taken;
}

int accept(int file, sockaddr* address, socklen_t* size) { return accept4(file, address, size, 0); }

int getsockname(int file, sockaddr* address, socklen_t* size) noexcept {
  static const auto call = real<int (*)(int, sockaddr*, socklen_t*)>("getsockname");
  const Descriptor* known = socket_of(file);
  return known == nullptr ? call(file, address, size) : put_address(known->port, address, size);
}

int getpeername(int file, sockaddr* address, socklen_t* size) noexcept {
  static const auto call = real<int (*)(int, sockaddr*, socklen_t*)>("getpeername");
  const Descriptor* known = socket_of(file);
  return known == nullptr ? call(file, address, size) : put_address(known->peer, address, size);
}

int setsockopt(int file, int level, int name, const void* value, socklen_t size) noexcept {
  static const auto call = real<int (*)(int, int, int, const void*, socklen_t)>("setsockopt");
  if (socket_of(file) != nullptr && level != SOL_SOCKET) return 0;
  return call(file, level, name, value, size);
}

ssize_t send(int file, const void* bytes, std::size_t size, int flags) {
  return then_wake<ssize_t (*)(int, const void*, std::size_t, int)>("send", file, bytes, size,
                                                                    flags);
}
ssize_t sendmsg(int file, const msghdr* message, int flags) {
  return then_wake<ssize_t (*)(int, const msghdr*, int)>("sendmsg", file, message, flags);
}
ssize_t recv(int file, void* bytes, std::size_t size, int flags) {
  return then_wake<ssize_t (*)(int, void*, std::size_t, int)>("recv", file, bytes, size, flags);
}
ssize_t recvmsg(int file, msghdr* message, int flags) {
  return then_wake<ssize_t (*)(int, msghdr*, int)>("recvmsg", file, message, flags);
}
int shutdown(int file, int how) noexcept {
  return then_wake<int (*)(int, int)>("shutdown", file, how);
}
int close(int file) {
  if (takes_turns()) Descriptors::instance().remove(file);
  return then_wake<int (*)(int)>("close", file);
}

/// Boost.Asio wakes a thread by arming a descriptor again that is ready already.
int epoll_ctl(int file, int operation, int of, epoll_event* event) noexcept {
  return then_wake<int (*)(int, int, int, epoll_event*)>("epoll_ctl", file, operation, of, event);
}

int timerfd_create(int clock, int flags) noexcept {
  static const auto call = real<int (*)(int, int)>("timerfd_create");
  if (!takes_turns()) return call(clock, flags);
  const int file = eventfd(0, EFD_NONBLOCK | ((flags & TFD_CLOEXEC) != 0 ? EFD_CLOEXEC : 0));
  if (file >= 0) Descriptors::instance().add(file, Descriptor::Kind::kTimer);
  return file;
}

int timerfd_settime(int file, int flags, const itimerspec* time, itimerspec* old) noexcept {
  static const auto call =
      real<int (*)(int, int, const itimerspec*, itimerspec*)>("timerfd_settime");
  Descriptor* timer =
      takes_turns() ? Descriptors::instance().find(file, Descriptor::Kind::kTimer) : nullptr;
  if (timer == nullptr) return call(file, flags, time, old);
  std::uint64_t expired = 0;  // a timer that is set again has not expired
  (void)!read(file, &expired, sizeof expired);
  const Time value = time->it_value.tv_sec * kSecond + time->it_value.tv_nsec;
  const Machine* machine = this_machine();
  timer->expires = kNever;
  if (value != 0) {
    const bool is_absolute = (flags & TFD_TIMER_ABSTIME) != 0;
    const Time shown = machine == nullptr ? now() : machine->monotonic(now());
    const Time at = is_absolute ? value : shown + value;
    timer->expires = machine == nullptr ? at : machine->when(at);
  }
  if (old != nullptr) *old = {};
  return 0;
}

int epoll_wait(int file, epoll_event* events, int count, int timeout_ms) {
  static const auto call = real<int (*)(int, epoll_event*, int, int)>("epoll_wait");
  if (!takes_turns()) return call(file, events, count, timeout_ms);
  may_switch();
  const Time end = timeout_ms < 0 ? kNever : now() + timeout_ms * kMillisecond;
  for (;;) {
    const int ready = call(file, events, count, 0);
    if (ready != 0 || timeout_ms == 0 || now() >= end) return ready;
    pollfd wanted{file, POLLIN, 0};
    wait_for_input(&wanted, 1, end);
  }
}

int poll(pollfd* files, nfds_t count, int timeout_ms) {
  static const auto call = real<int (*)(pollfd*, nfds_t, int)>("poll");
  if (!takes_turns()) return call(files, count, timeout_ms);
  may_switch();
  const Time end = timeout_ms < 0 ? kNever : now() + timeout_ms * kMillisecond;
  for (;;) {
    const int ready = call(files, count, 0);
    if (ready != 0 || timeout_ms == 0 || now() >= end) return ready;
    wait_for_input(files, count, end);
  }
}

}  // extern "C"
