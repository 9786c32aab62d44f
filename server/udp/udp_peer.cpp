// SPDX-License-Identifier: Apache-2.0
#include "server/udp/udp_peer.h"

#include <unistd.h>

#include <array>
#include <utility>
#include <vector>

#include "server/metrics/metrics.h"

namespace kerf::net {
namespace {

DatagramDrop drop_for(datagram::Fault fault) {
  switch (fault) {
    case datagram::Fault::kReplayed:
      return DatagramDrop::kReplayed;
    case datagram::Fault::kNotAuthentic:
      return DatagramDrop::kNotAuthentic;
    case datagram::Fault::kOtherConnection:
      return DatagramDrop::kUnknownConnection;
    case datagram::Fault::kTooShort:
    case datagram::Fault::kTooLong:
    case datagram::Fault::kBadMagic:
      break;
  }
  return DatagramDrop::kMalformed;
}

}  // namespace

UdpSocket::~UdpSocket() { ::close(descriptor_); }

UdpPeer::UdpPeer(std::shared_ptr<UdpSocket> socket, const datagram::Offer& offer,
                 Executor& executor, Take take, Metrics& metrics)
    : socket_(std::move(socket)),
      offer_(offer),
      executor_(executor),
      take_(std::move(take)),
      metrics_(metrics),
      opener_(offer.connection, offer.to_server),
      sealer_(offer.connection, offer.to_agent) {}

void UdpPeer::receive(std::span<const std::byte> datagram, const UdpAddress& from,
                      Clock::time_point arrived) {
  std::array<std::byte, datagram::kMaxFrameBytes> frame;
  const auto opened = opener_.open(datagram, frame);
  if (!opened) return metrics_.datagram_dropped(drop_for(opened.error()));
  metrics_.datagram_received();
  if (opened->newest) {
    const std::scoped_lock lock(address_mutex_);
    address_ = from;
  }
  if (!rate_.allow(arrived) || waiting_ >= kWaitingMax) {
    return metrics_.datagram_dropped(DatagramDrop::kTooMany);
  }
  ++waiting_;
  std::vector<std::byte> copy(frame.begin(),
                              frame.begin() + static_cast<long>(opened->frame_bytes));
  executor_.post([self = shared_from_this(), copy = std::move(copy), arrived] {
    --self->waiting_;
    self->take_(copy, arrived);
  });
}

void UdpPeer::send(std::span<const std::byte> frame) {
  UdpAddress to;
  {
    const std::scoped_lock lock(address_mutex_);
    to = address_;
  }
  if (to.peer_bytes == 0) return;
  std::array<std::byte, datagram::kMaxBytes> out;
  const std::size_t bytes = sealer_.seal(frame, out);
  // A datagram that the system does not accept at once is lost, as it might be on the network.
  if (bytes > 0 && send_datagram(socket_->descriptor(), std::span(out).first(bytes), to)) {
    metrics_.datagram_sent();
  }
}

}  // namespace kerf::net
