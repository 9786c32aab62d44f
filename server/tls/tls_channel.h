// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "server/tls/tls_context.h"

struct ssl_st;

namespace kerf::net {

/// State of an operation of a TlsChannel.
enum class TlsStep : std::uint8_t {
  kDone,
  kWantsRead,   ///< repeat it with the same arguments when the socket is readable
  kWantsWrite,  ///< the same, writable
  kClosed,      ///< the peer sends no more data
  kFailed,      ///< failure() says why; the channel must not be used any more
};

/// One TLS connection over a connected TCP socket. Has no threads and never waits. Its owner waits
/// for the socket. Calls must not overlap.
class TlsChannel {
 public:
  /// The server's end. `socket` must outlive the channel.
  TlsChannel(const TlsContext& context, int socket);
  /// The client's end: the server must prove that it is `host`, a DNS name or an IP address.
  TlsChannel(const TlsContext& context, int socket, std::string host);
  ~TlsChannel();
  TlsChannel(const TlsChannel&) = delete;
  TlsChannel& operator=(const TlsChannel&) = delete;

  /// Must be completed before any other operation.
  TlsStep handshake();
  /// Reads 1 to `to.size()` bytes.
  TlsStep read(std::span<std::byte> to, std::size_t& count);
  /// Writes at least one of the bytes.
  TlsStep write(std::span<const std::byte> from, std::size_t& count);
  /// Notifies the peer that no more data follows, if the socket accepts it.
  void say_end();
  /// Whether the peer has closed its end, as far as data has arrived. Consumes nothing.
  bool has_peer_ended();

  /// Why the handshake, or an operation, has failed: one clause for users.
  std::string failure() const { return failure_; }
  /// Whether the failure comes from the peer, not from the network, so that retrying does not help.
  bool is_final() const { return is_final_; }
  /// Whether the handshake has failed because the peer speaks HTTP, or something else, without TLS.
  bool is_peer_plain() const { return is_peer_plain_; }

 private:
  struct Native;
  TlsStep judge(int result);
  std::string describe_failure(unsigned long code) const;

  std::string host_;  ///< empty: a server's end
  std::unique_ptr<Native> native_;
  std::string failure_;
  bool is_final_ = false, is_peer_plain_ = false;
};

}  // namespace kerf::net
