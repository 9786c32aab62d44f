// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <memory>
#include <span>

#include "server/datagram/key.h"
#include "server/datagram/layout.h"
#include "server/datagram/replay_window.h"

struct evp_cipher_ctx_st;  // EVP_CIPHER_CTX; OpenSSL is included by the .cpp only

namespace kerf::datagram {

struct CipherEnd {
  void operator()(evp_cipher_ctx_st* context) const noexcept;
};
using CipherContext = std::unique_ptr<evp_cipher_ctx_st, CipherEnd>;

/// Encrypts and authenticates the frames of one direction of one connection.
class Sealer {
 public:
  Sealer(std::uint32_t connection, const Key& key, std::uint64_t first_counter = 1);

  /// Writes the datagram of `frame` to the start of `out` (at least kMaxBytes) and returns its
  /// size. Returns 0 if the frame is empty or longer than kMaxFrameBytes, or if encryption fails.
  std::size_t seal(std::span<const std::byte> frame, std::span<std::byte> out) noexcept;

 private:
  CipherContext context_;
  Header next_;
};

/// The result of opening a datagram.
struct Opened {
  std::size_t frame_bytes = 0;
  /// The counter is the highest so far: the datagram's source is the peer's current address.
  bool newest = false;
};

/// Decrypts and verifies the datagrams of one direction of one connection; accepts each only once.
class Opener {
 public:
  Opener(std::uint32_t connection, const Key& key);

  /// Writes the decrypted frame to the start of `frame` (at least kMaxFrameBytes). A fault changes
  /// only the contents of `frame`.
  std::expected<Opened, Fault> open(std::span<const std::byte> datagram,
                                    std::span<std::byte> frame) noexcept;

  /// The highest counter received.
  std::uint64_t newest() const noexcept { return window_.newest(); }
  /// Number of datagrams accepted; newest() - opened() were lost.
  std::uint64_t opened() const noexcept { return opened_; }

 private:
  std::uint32_t connection_;
  CipherContext context_;
  ReplayWindow window_;
  std::uint64_t opened_ = 0;
};

}  // namespace kerf::datagram
