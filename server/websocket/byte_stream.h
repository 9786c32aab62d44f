// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/async_result.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "server/tls/tls_channel.h"

namespace kerf::net {

/// A connected TCP socket, with or without TLS: an asynchronous stream of Asio, on which Beast
/// implements HTTP and WebSockets. One type for both, so that Beast's templates are compiled once.
/// At most one read and one write may be in progress. The stream must not move during them, and
/// must outlive them. Everything runs on the one thread of the socket's executor.
class ByteStream {
 public:
  using executor_type = boost::asio::any_io_executor;
  using Done = std::move_only_function<void(boost::system::error_code, std::size_t)>;

  explicit ByteStream(boost::asio::ip::tcp::socket socket,
                      std::unique_ptr<TlsChannel> tls = nullptr)
      : socket_(std::move(socket)), tls_(std::move(tls)) {}
  ByteStream(ByteStream&&) = default;
  ~ByteStream() {
    if (out_) out_->socket = nullptr;
  }

  executor_type get_executor() { return socket_.get_executor(); }
  /// For options, addresses and waiting. With TLS, its data is ciphertext.
  boost::asio::ip::tcp::socket& socket() { return socket_; }
  /// Null without TLS.
  TlsChannel* tls() { return tls_.get(); }
  /// Releases the channel, to continue with the same TCP socket on another thread.
  std::unique_ptr<TlsChannel> release_tls() { return std::move(tls_); }

  /// Performs the handshake if there is TLS. On failure the channel says why.
  boost::asio::awaitable<boost::system::error_code> shake_hands();
  /// Whether written data is held for the next write, so that both leave together, in one system
  /// call if they are short. Ignored with TLS.
  void hold(bool on) { hold_ = on; }
  /// Sends held data, because nothing follows.
  void flush();
  /// Notifies the peer that no more data follows, in TLS too.
  void end_sending();
  /// Whether the peer has closed its end, as far as data has arrived.
  bool has_peer_ended();
  /// Closes the socket. Operations in progress end with an error.
  void close();

  template <class Buffers, class Token>
  auto async_read_some(const Buffers& buffers, Token&& token) {
    return boost::asio::async_initiate<Token, void(boost::system::error_code, std::size_t)>(
        [this](auto handler, const Buffers& to) {
          if (!tls_) return socket_.async_read_some(to, std::move(handler));
          read_tls(first_of(to), Done(std::move(handler)));
        },
        token, buffers);
  }
  template <class Buffers, class Token>
  auto async_write_some(const Buffers& buffers, Token&& token) {
    return boost::asio::async_initiate<Token, void(boost::system::error_code, std::size_t)>(
        [this](auto handler, const Buffers& from) {
          if (!tls_ && !hold_ && out_->held.empty())
            return socket_.async_send(from, std::move(handler));
          if (!tls_) return send_or_hold(parts_of(from), std::move(handler));
          // One record for all parts, at most as large as TLS allows.
          outgoing_.resize(std::min(boost::asio::buffer_size(from), kRecordBytes));
          boost::asio::buffer_copy(boost::asio::buffer(outgoing_), from);
          write_tls(Done(std::move(handler)));
        },
        token, buffers);
  }

 private:
  static constexpr std::size_t kRecordBytes = std::size_t{16} * 1024;
  static constexpr std::size_t kHeldBytesMax = 2048;
  /// Parts of a message that are sent at once. Further parts are sent afterwards.
  using Parts = std::array<boost::asio::const_buffer, 6>;
  using Attempt = std::move_only_function<TlsStep(std::size_t& count)>;

  template <class Buffers>
  static boost::asio::mutable_buffer first_of(const Buffers& buffers) {
    const auto end = boost::asio::buffer_sequence_end(buffers);
    for (auto part = boost::asio::buffer_sequence_begin(buffers); part != end; ++part) {
      const boost::asio::mutable_buffer bytes = *part;
      if (bytes.size() > 0) return bytes;
    }
    return {};
  }
  template <class Buffers>
  static Parts parts_of(const Buffers& buffers) {
    Parts parts{};
    std::size_t count = 0;  // the first one is for held data
    const auto end = boost::asio::buffer_sequence_end(buffers);
    for (auto part = boost::asio::buffer_sequence_begin(buffers); part != end; ++part) {
      const boost::asio::const_buffer bytes = *part;
      if (bytes.size() == 0) continue;
      if (++count == parts.size()) break;
      parts.at(count) = bytes;
    }
    return parts;
  }
  /// Held data. An operation in progress shares it, because one of a WebSocket's own, such as a
  /// ping, may end after the stream.
  struct Outgoing {
    std::vector<std::byte> held;
    bool is_sending = false;
    boost::asio::ip::tcp::socket* socket = nullptr;  ///< null: the stream is gone
  };
  /// Sends the parts after the held data, or holds them.
  template <class Handler>
  void send_or_hold(Parts parts, Handler handler) {
    std::vector<std::byte>& held = out_->held;
    const std::size_t bytes = boost::asio::buffer_size(parts);
    if (!hold_ || bytes == 0 || held.size() + bytes > kHeldBytesMax) {
      out_->socket = &socket_;
      return send(out_, parts, hold_, std::move(handler));
    }
    const std::size_t before = held.size();
    held.resize(before + bytes);
    boost::asio::buffer_copy(boost::asio::buffer(held) + before, parts);
    auto done = [handler = std::move(handler), bytes]() mutable {
      std::move(handler)(boost::system::error_code(), bytes);
    };
    boost::asio::post(get_executor(), std::move(done));
  }
  template <class Handler>
  static void send(const std::shared_ptr<Outgoing>& out, Parts parts, bool more, Handler handler) {
    parts.front() = boost::asio::buffer(out->held);
    out->is_sending = true;
    auto sent = [out, parts, more, handler = std::move(handler)](boost::system::error_code error,
                                                                 std::size_t count) mutable {
      out->is_sending = false;
      const std::size_t held = std::min(count, out->held.size());
      out->held.erase(out->held.begin(), out->held.begin() + static_cast<std::ptrdiff_t>(held));
      parts.front() = {};
      // None of the requested data has left yet.
      if (!error && out->socket != nullptr && count == held &&
          boost::asio::buffer_size(parts) > 0) {
        return send(out, parts, more, std::move(handler));
      }
      std::move(handler)(error, count - held);
    };
    out->socket->async_send(parts, more ? MSG_MORE : 0, std::move(sent));
  }
  void read_tls(boost::asio::mutable_buffer to, Done done);
  void write_tls(Done done);
  void go_on(Attempt attempt, Done done, bool is_first);

  boost::asio::ip::tcp::socket socket_;
  std::unique_ptr<TlsChannel> tls_;
  bool hold_ = false;
  std::shared_ptr<Outgoing> out_ = std::make_shared<Outgoing>();
  std::vector<std::byte> outgoing_;  ///< being written with TLS
};

/// For Beast: closes a WebSocket whose deadline has passed.
inline void beast_close_socket(ByteStream& stream) { stream.close(); }

}  // namespace kerf::net
