// SPDX-License-Identifier: Apache-2.0
#include "server/socket/peer_socket.h"

#include <array>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <chrono>
#include <utility>

#include "server/platform/clock.h"

namespace kerf::net {

namespace asio = boost::asio;
using boost::system::error_code;

namespace {

/// Frames between the protocol's limit and this one are answered with a typed error. No
/// compression, because a shared frame is encoded once for all.
constexpr WebSocketLimits kLimits{
    .handshake = std::chrono::seconds(5),
    .idle = std::chrono::seconds(20),
    .message_bytes = std::size_t{64} * 1024,
};

}  // namespace

PeerSocket::PeerSocket(ByteStream stream, std::string_view protocol, std::int64_t remaining_s,
                       std::chrono::milliseconds leave_time)
    : socket_(std::move(stream), kLimits),
      protocol_(protocol),
      remaining_s_(remaining_s),
      leave_time_(leave_time),
      hello_timer_(socket_.executor()),
      grant_timer_(socket_.executor()),
      leave_timer_(socket_.executor()) {}

void PeerSocket::start(UpgradeRequest request) {
  auto run = [self = shared_from_this(), request = std::move(request)]() mutable {
    return self->run(std::move(request));
  };
  asio::co_spawn(socket_.executor(), std::move(run), asio::detached);
}

asio::awaitable<void> PeerSocket::act() { co_return; }

asio::awaitable<void> PeerSocket::run(UpgradeRequest request) {
  error_code error = co_await socket_.accept(request, protocol_);
  if (!error) {
    open_ = true;
    limit_hello();
    limit_grant();
    pump();
  }
  while (!error && !failed_ && !conversation().broken()) {
    error = co_await socket_.read();
    if (error) break;
    const auto arrived = Clock::now();
    // An agent's batch received over UDP in the meantime precedes this frame.
    if (conversation().has_action()) co_await act();
    if (failed_) break;  // act() has not finished the batch
    conversation().receive(socket_.message(), socket_.is_text(), arrived);
    pump();
    conversation().refresh();
    pump();
    if (conversation().has_action()) co_await act();
  }
  hello_timer_.cancel();
  grant_timer_.cancel();
  open_ = false;
  leave_timer_.cancel();
  closed();
}

void PeerSocket::limit_hello() {
  hello_timer_.expires_after(std::chrono::microseconds(std::int64_t(wire::kHelloTimeoutS * 1e6)));
  hello_timer_.async_wait([self = shared_from_this()](error_code error) {
    if (error) return;
    self->conversation().hello_expired();
    self->pump();
  });
}

void PeerSocket::limit_grant() {
  if (remaining_s_ < 0) return;
  grant_timer_.expires_after(std::chrono::seconds(remaining_s_));
  grant_timer_.async_wait([self = shared_from_this()](error_code error) {
    if (error) return;
    self->conversation().grant_expired();
    self->pump();
  });
}

/// A peer that does not read blocks the last frames, and any byte from it resets the idle timer.
void PeerSocket::limit_leaving() {
  if (std::exchange(leaving_, true)) return;
  leave_timer_.expires_after(leave_time_);
  leave_timer_.async_wait([self = shared_from_this()](error_code error) {
    if (!error) self->socket_.cut();
  });
}

void PeerSocket::pump() {
  if (!open_ || failed_) return;
  if (conversation().broken()) return socket_.cut();
  if (conversation().finishing()) limit_leaving();
  if (writing_) return;
  const bool leaves = conversation().take(out_);
  if (!leaves) socket_.flush();  // the expected next frame has been dropped
  if (!leaves && !conversation().finishing()) return;
  writing_ = true;
  if (!leaves) {
    auto close = [self = shared_from_this()]() -> asio::awaitable<void> {
      co_await self->socket_.close(kGoingAway);
    };
    return asio::co_spawn(socket_.executor(), std::move(close), asio::detached);
  }
  const std::array<asio::const_buffer, 2> parts = {
      asio::buffer(out_.bytes), out_.shared ? asio::buffer(*out_.shared) : asio::const_buffer()};
  socket_.hold(conversation().has_more());
  socket_.write(out_.is_text(), parts,
                [self = shared_from_this()](error_code error) { self->written(error); });
}

void PeerSocket::written(error_code error) {
  writing_ = false;
  if (error) {
    failed_ = true;
    return;
  }
  conversation().sent(out_);
  pump();
}

}  // namespace kerf::net
