// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/link/datagram_socket.h"

#include <array>

#include "haptic_agent/link/connection.h"

namespace kerf::agent {

namespace asio = boost::asio;
using asio::ip::udp;
using boost::system::error_code;

DatagramSocket::DatagramSocket(asio::io_context& io, const asio::ip::address& server,
                               const datagram::Offer& offer, UdpReport& counts)
    : socket_(io),
      sealer_(offer.connection, offer.to_server),
      opener_(offer.connection, offer.to_agent),
      counts_(counts),
      lost_before_(counts.lost) {
  const udp::endpoint remote(server, offer.port);
  error_code failed;
  if (socket_.open(remote.protocol(), failed)) return;
  // Connect the socket, so that the kernel drops datagrams from other addresses.
  if (!socket_.connect(remote, failed)) socket_.non_blocking(true, failed);
  if (failed) close();
}

void DatagramSocket::send(std::span<const std::byte> frame) {
  std::array<std::byte, datagram::kMaxBytes> out;
  const std::size_t bytes = sealer_.seal(frame, out);
  error_code failed;
  if (bytes > 0) socket_.send(asio::buffer(out.data(), bytes), 0, failed);
  if (bytes > 0 && !failed) ++counts_.sent;
}

asio::awaitable<void> DatagramSocket::read_all(
    std::function<void(std::span<const std::byte>)> take) {
  while (socket_.is_open()) {
    co_await socket_.async_wait(udp::socket::wait_read, kAwait);
    while (receive(take)) {
    }
  }
}

bool DatagramSocket::receive(const std::function<void(std::span<const std::byte>)>& take) {
  std::array<std::byte, datagram::kMaxBytes + 1> bytes;
  error_code failed;
  const std::size_t count = socket_.receive(asio::buffer(bytes), 0, failed);
  // "Connection refused" refers to an earlier datagram to a closed port. Later ones may arrive.
  if (failed) return failed == asio::error::connection_refused;
  std::array<std::byte, datagram::kMaxFrameBytes> frame;
  const auto opened = opener_.open(std::span(bytes).first(count), frame);
  if (!opened) {
    ++counts_.dropped;
    return true;
  }
  ++counts_.received;
  counts_.lost = lost_before_ + opener_.newest() - opener_.opened();
  take(std::span(frame).first(opened->frame_bytes));
  return true;
}

void DatagramSocket::close() {
  error_code ignored;
  socket_.close(ignored);
}

}  // namespace kerf::agent
