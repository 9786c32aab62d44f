// SPDX-License-Identifier: Apache-2.0
#include "server/store/zstd_pack.h"

#include <zstd.h>

#include <new>

namespace kerf {

struct ZstdPack::Contexts {
  ZSTD_CCtx* compress = ZSTD_createCCtx();
  ZSTD_DCtx* decompress = ZSTD_createDCtx();
  Contexts() {
    if (compress == nullptr || decompress == nullptr) throw std::bad_alloc();
  }
  Contexts(const Contexts&) = delete;
  Contexts& operator=(const Contexts&) = delete;
  ~Contexts() {
    ZSTD_freeCCtx(compress);
    ZSTD_freeDCtx(decompress);
  }
};

ZstdPack::ZstdPack() : contexts_(std::make_unique<Contexts>()) {}
ZstdPack::ZstdPack(ZstdPack&&) noexcept = default;
ZstdPack::~ZstdPack() = default;

std::span<const std::byte> ZstdPack::pack(std::span<const std::byte> bytes) {
  buffer_.resize(ZSTD_compressBound(bytes.size()));
  const std::size_t size = ZSTD_compressCCtx(contexts_->compress, buffer_.data(), buffer_.size(),
                                             bytes.data(), bytes.size(), 1);
  // With a buffer of the bound's size, compression can only fail for lack of memory.
  if (ZSTD_isError(size) != 0) throw std::bad_alloc();
  return std::span(buffer_).first(size);
}

std::optional<std::span<const std::byte>> ZstdPack::unpack(std::span<const std::byte> frame,
                                                           std::size_t size) {
  const unsigned long long stated = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (stated != size && stated != ZSTD_CONTENTSIZE_UNKNOWN) return std::nullopt;
  buffer_.resize(size);
  const std::size_t found =
      ZSTD_decompressDCtx(contexts_->decompress, buffer_.data(), size, frame.data(), frame.size());
  if (found != size) return std::nullopt;
  return std::span<const std::byte>(buffer_);
}

}  // namespace kerf
