// SPDX-License-Identifier: Apache-2.0
#include "server/websocket/byte_stream.h"

#include <sys/socket.h>

#include <boost/asio/error.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <span>

namespace kerf::net {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

error_code error_of(TlsStep step) {
  if (step == TlsStep::kDone) return {};
  if (step == TlsStep::kClosed) return asio::error::eof;
  return asio::error::connection_aborted;
}

bool waits(TlsStep step) { return step == TlsStep::kWantsRead || step == TlsStep::kWantsWrite; }

tcp::socket::wait_type event_of(TlsStep step) {
  return step == TlsStep::kWantsRead ? tcp::socket::wait_read : tcp::socket::wait_write;
}

}  // namespace

asio::awaitable<error_code> ByteStream::shake_hands() {
  if (!tls_) co_return error_code();
  for (;;) {
    const TlsStep step = tls_->handshake();
    if (!waits(step)) co_return error_of(step);
    error_code error;
    co_await socket_.async_wait(event_of(step), asio::redirect_error(asio::use_awaitable, error));
    if (error) co_return error;
  }
}

void ByteStream::flush() {
  std::vector<std::byte>& held = out_->held;
  if (out_->is_sending || held.empty() || !socket_.is_open()) return;
  // A peer that does not read gets the rest before the next data.
  const auto count =
      ::send(socket_.native_handle(), held.data(), held.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  if (count > 0) held.erase(held.begin(), held.begin() + count);
}

void ByteStream::end_sending() {
  if (!socket_.is_open()) return;
  if (tls_) tls_->say_end();
  error_code ignored;
  socket_.shutdown(tcp::socket::shutdown_send, ignored);
}

bool ByteStream::has_peer_ended() {
  if (!socket_.is_open()) return true;
  if (tls_) return tls_->has_peer_ended();
  char next = 0;
  return recv(socket_.native_handle(), &next, 1, MSG_PEEK | MSG_DONTWAIT) == 0;
}

void ByteStream::close() {
  error_code ignored;
  socket_.close(ignored);
}

void ByteStream::read_tls(asio::mutable_buffer to, Done done) {
  const std::span<std::byte> bytes(static_cast<std::byte*>(to.data()), to.size());
  const auto attempt = [this, bytes](std::size_t& count) {
    return bytes.empty() ? TlsStep::kDone : tls_->read(bytes, count);
  };
  go_on(attempt, std::move(done), true);
}

void ByteStream::write_tls(Done done) {
  const auto attempt = [this](std::size_t& count) {
    return outgoing_.empty() ? TlsStep::kDone : tls_->write(outgoing_, count);
  };
  go_on(attempt, std::move(done), true);
}

/// Repeats the attempt until it has ended. An operation never ends within the call that starts it.
void ByteStream::go_on(Attempt attempt, Done done, bool is_first) {
  std::size_t count = 0;
  // By now the number of a closed descriptor may belong to another connection.
  const bool is_open = socket_.is_open();
  const TlsStep step = is_open ? attempt(count) : TlsStep::kFailed;
  if (waits(step)) {
    socket_.async_wait(event_of(step), [this, attempt = std::move(attempt),
                                        done = std::move(done)](error_code error) mutable {
      if (error) return done(error, 0);
      go_on(std::move(attempt), std::move(done), false);
    });
    return;
  }
  const error_code error = is_open ? error_of(step) : asio::error::operation_aborted;
  if (!is_first) return done(error, count);
  asio::post(socket_.get_executor(),
             [done = std::move(done), error, count]() mutable { done(error, count); });
}

}  // namespace kerf::net
