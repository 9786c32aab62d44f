// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace kerf {

/// Compresses and decompresses with Zstandard (RFC 8878) at its fastest usual level. Reuses its
/// memory between calls.
class ZstdPack {
 public:
  ZstdPack();
  ZstdPack(ZstdPack&&) noexcept;
  ~ZstdPack();

  /// The result is valid until the next call.
  std::span<const std::byte> pack(std::span<const std::byte> bytes);
  /// Returns the `size` bytes of a frame, valid until the next call. Nullopt if the frame is
  /// malformed or of another size. It need not state its size.
  std::optional<std::span<const std::byte>> unpack(std::span<const std::byte> frame,
                                                   std::size_t size);

 private:
  struct Contexts;
  std::unique_ptr<Contexts> contexts_;
  std::vector<std::byte> buffer_;
};

}  // namespace kerf
