// SPDX-License-Identifier: Apache-2.0
#include "server/udp/udp_port.h"

#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>
#include <utility>

#include "server/metrics/metrics.h"
#include "server/platform/clock.h"

namespace kerf::net {
namespace {

/// Buffers some hundred datagrams while the thread is not scheduled.
constexpr int kReceiveBytes = 1 << 20;
/// Datagrams read between two checks whether to stop.
constexpr int kBurst = 64;

}  // namespace

UdpPort::~UdpPort() {
  if (!thread_.joinable()) return;
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(stop_, &one, sizeof one);
  thread_.join();
  ::close(stop_);
}

std::expected<void, std::string> UdpPort::listen(const std::string& address, std::uint16_t port) {
  const auto fail = [&](const std::string& why) {
    return std::unexpected("cannot listen for UDP on " + address + ":" + std::to_string(port) +
                           ": " + why);
  };
  const auto here = to_address(address, port);
  if (!here) return fail("not an IP address");
  const int descriptor =
      ::socket(here->peer.ss_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return fail(std::generic_category().message(errno));
  auto socket = std::make_shared<UdpSocket>(descriptor);
  ::setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &kReceiveBytes, sizeof kReceiveBytes);
  request_local_address(descriptor, here->peer.ss_family);
  if (::bind(descriptor, reinterpret_cast<const sockaddr*>(&here->peer), here->peer_bytes) != 0) {
    return fail(std::generic_category().message(errno));
  }
  stop_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (stop_ < 0) return fail(std::generic_category().message(errno));
  socket_ = std::move(socket);
  port_ = port_of(descriptor);
  thread_ = std::thread([this] { run(); });
  return {};
}

std::shared_ptr<UdpPeer> UdpPort::open(Executor& executor, UdpPeer::Take take) {
  if (port_ == 0) return nullptr;
  const std::scoped_lock lock(mutex_);
  auto offer = datagram::random_offer(port_);
  while (offer && peers_.contains(offer->connection)) offer = datagram::random_offer(port_);
  if (!offer) return nullptr;
  auto peer = std::make_shared<UdpPeer>(socket_, *offer, executor, std::move(take), metrics_);
  peers_.emplace(offer->connection, peer);
  return peer;
}

void UdpPort::close(const UdpPeer& peer) {
  const std::scoped_lock lock(mutex_);
  peers_.erase(peer.offer().connection);
}

void UdpPort::run() {
  pthread_setname_np(pthread_self(), "udp");
  std::array<pollfd, 2> events{pollfd{socket_->descriptor(), POLLIN, 0}, pollfd{stop_, POLLIN, 0}};
  for (;;) {
    ::poll(events.data(), events.size(), -1);
    if (events[1].revents != 0) return;
    for (int i = 0; i < kBurst && receive_one(); ++i) {
    }
  }
}

/// Returns false if no datagram was waiting.
bool UdpPort::receive_one() {
  // One byte more than the longest datagram, to detect longer ones.
  std::array<std::byte, datagram::kMaxBytes + 1> bytes;
  UdpAddress from;
  const ssize_t count = receive_datagram(socket_->descriptor(), bytes, from);
  if (count < 0) return errno == EINTR;
  const auto arrived = Clock::now();
  const auto datagram = std::span(bytes).first(static_cast<std::size_t>(count));
  const auto header = datagram::read_header(datagram);
  if (!header) {
    metrics_.datagram_dropped(DatagramDrop::kMalformed);
    return true;
  }
  const std::scoped_lock lock(mutex_);
  const auto peer = peers_.find(header->connection);
  if (peer == peers_.end()) {
    metrics_.datagram_dropped(DatagramDrop::kUnknownConnection);
  } else {
    peer->second->receive(datagram, from, arrived);
  }
  return true;
}

}  // namespace kerf::net
