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

struct evp_cipher_ctx_st;  // of OpenSSL, which stays in the .cpp

namespace kerf::datagram {

struct CipherEnd {
  void operator()(evp_cipher_ctx_st* context) const noexcept;
};
using CipherContext = std::unique_ptr<evp_cipher_ctx_st, CipherEnd>;

/// Seals the frames of one direction of one connection.
class Sealer {
 public:
  Sealer(std::uint32_t connection, const Key& key, std::uint64_t first_counter = 1);

  /// Writes the datagram to the start of `out` (kMaxBytes) and returns its size; 0 if the frame is
  /// longer than kMaxFrameBytes, empty, or cannot be sealed.
  std::size_t seal(std::span<const std::byte> frame, std::span<std::byte> out) noexcept;

 private:
  CipherContext context_;
  Header next_;
};

/// A frame that was under seal.
struct Opened {
  std::size_t frame_bytes = 0;
  /// No datagram of this direction has had a higher counter: whoever has sent it is where the peer
  /// is now.
  bool newest = false;
};

/// Opens the datagrams of one direction of one connection, each once.
class Opener {
 public:
  Opener(std::uint32_t connection, const Key& key);

  /// Writes the frame to the start of `frame` (kMaxFrameBytes). After a fault everything is as
  /// before, but for what `frame` holds.
  std::expected<Opened, Fault> open(std::span<const std::byte> datagram,
                                    std::span<std::byte> frame) noexcept;

  /// The highest counter seen, and how many datagrams have passed: the difference went astray.
  std::uint64_t newest() const noexcept { return window_.newest(); }
  std::uint64_t opened() const noexcept { return opened_; }

 private:
  std::uint32_t connection_;
  CipherContext context_;
  ReplayWindow window_;
  std::uint64_t opened_ = 0;
};

}  // namespace kerf::datagram
