#include "server/net/udp_port.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <pthread.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <system_error>
#include <utility>

#include "server/net/metrics.h"

namespace kerf::net {
namespace {

/// Room for a moment in which the thread does not run: some hundred datagrams.
constexpr int kReceiveBytes = 1 << 20;
/// Read this many before looking whether to stop.
constexpr int kAtOnce = 64;

std::optional<UdpAddress> to_address(const std::string& text, std::uint16_t port) {
  UdpAddress address;
  in_addr four{};
  if (inet_pton(AF_INET, text.c_str(), &four) == 1) {
    sockaddr_in in{};
    in.sin_family = AF_INET;
    in.sin_port = htons(port);
    in.sin_addr = four;
    address.bytes = sizeof in;
    std::memcpy(&address.storage, &in, sizeof in);
    return address;
  }
  sockaddr_in6 in{};
  if (inet_pton(AF_INET6, text.c_str(), &in.sin6_addr) != 1) return std::nullopt;
  in.sin6_family = AF_INET6;
  in.sin6_port = htons(port);
  address.bytes = sizeof in;
  std::memcpy(&address.storage, &in, sizeof in);
  return address;
}

std::uint16_t port_of(int descriptor) {
  sockaddr_storage storage{};
  socklen_t bytes = sizeof storage;
  if (getsockname(descriptor, reinterpret_cast<sockaddr*>(&storage), &bytes) != 0) return 0;
  in_port_t port = 0;  // at the same place in both families
  static_assert(offsetof(sockaddr_in, sin_port) == offsetof(sockaddr_in6, sin6_port));
  std::memcpy(&port, reinterpret_cast<const char*>(&storage) + offsetof(sockaddr_in, sin_port),
              sizeof port);
  return ntohs(port);
}

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
    return std::unexpected("no UDP lane on " + address + ":" + std::to_string(port) + ": " + why);
  };
  const auto here = to_address(address, port);
  if (!here) return fail("no IP address");
  const int descriptor =
      ::socket(here->storage.ss_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return fail(std::generic_category().message(errno));
  auto socket = std::make_shared<UdpSocket>(descriptor);
  ::setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &kReceiveBytes, sizeof kReceiveBytes);
  if (::bind(descriptor, reinterpret_cast<const sockaddr*>(&here->storage), here->bytes) != 0) {
    return fail(std::generic_category().message(errno));
  }
  stop_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (stop_ < 0) return fail(std::generic_category().message(errno));
  socket_ = std::move(socket);
  port_ = port_of(descriptor);
  thread_ = std::thread([this] { run(); });
  return {};
}

std::shared_ptr<UdpPeer> UdpPort::open(Executor& lane, UdpPeer::Take take) {
  if (port_ == 0) return nullptr;
  const std::scoped_lock lock(mutex_);
  auto offer = datagram::random_offer(port_);
  while (offer && peers_.contains(offer->connection)) offer = datagram::random_offer(port_);
  if (!offer) return nullptr;
  auto peer = std::make_shared<UdpPeer>(socket_, *offer, lane, std::move(take), metrics_);
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
    for (int i = 0; i < kAtOnce && receive_one(); ++i) {
    }
  }
}

/// False if nothing was there.
bool UdpPort::receive_one() {
  // One byte more than the longest, so that a longer one is seen to be longer.
  std::array<std::byte, datagram::kMaxBytes + 1> bytes;
  UdpAddress from;
  from.bytes = sizeof from.storage;
  const ssize_t count = ::recvfrom(socket_->descriptor(), bytes.data(), bytes.size(), MSG_DONTWAIT,
                                   reinterpret_cast<sockaddr*>(&from.storage), &from.bytes);
  if (count < 0) return errno == EINTR;
  const auto arrived = UdpPeer::Clock::now();
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
