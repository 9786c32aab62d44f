// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <istream>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/store/zstd_pack.h"

namespace kerf {

/// Maximum size of a chunk before compression. Readers allocate no more than this, whatever a file
/// states. A snapshot's chunk of tiles has at most 1 MB plus one tile, whose 1024 columns may have
/// 4,000 elements of 16 bytes each. Its head may have 500,000 poses of tools and users.
inline constexpr std::size_t kChunkBytesMax = std::size_t{64} << 20;

/// The temporary file of a ChunkWriter for `file`. A killed process leaves it behind.
std::filesystem::path unfinished_file(const std::filesystem::path& file);

/// Writes a file of compressed chunks with checksums (README.md, "Snapshots"). An existing file of
/// that name is only replaced when finish() succeeds.
class ChunkWriter {
 public:
  ChunkWriter(std::filesystem::path file, std::uint32_t version);
  ChunkWriter(const ChunkWriter&) = delete;
  ChunkWriter& operator=(const ChunkWriter&) = delete;
  /// Removes the file unless it was finished.
  ~ChunkWriter();

  /// Appends a chunk of 1 byte to kChunkBytesMax; a longer one is an error. No effect after an
  /// error.
  void write(std::span<const std::byte> chunk);
  /// Synchronizes the file with the disk and renames it. Unless `keep_as` is empty, the old file is
  /// renamed to it. Returns the size. The error is one sentence.
  std::expected<std::uint64_t, std::string> finish(const std::filesystem::path& keep_as = {});

 private:
  void put(std::span<const std::byte> bytes);
  void fail(const char* what);

  std::filesystem::path file_, temporary_;
  int descriptor_ = -1;
  std::string error_;
  std::uint64_t chunks_ = 0, bytes_ = 0;
  ZstdPack pack_;
};

/// Reads such a file.
class ChunkReader {
 public:
  ChunkReader(const std::filesystem::path& file, std::uint32_t version);
  /// Reads such a file from memory.
  ChunkReader(std::string contents, std::uint32_t version);
  /// Returns the next chunk, valid until the next call. The error is one sentence: the file is of
  /// another kind or version, damaged, or at its end.
  std::expected<std::span<const std::byte>, std::string> next();
  bool at_end() const { return left_ == 0; }

 private:
  bool read(std::span<std::byte> bytes);

  std::unique_ptr<std::istream> in_;
  std::uint32_t version_;
  std::uint64_t left_ = 0, chunks_ = 0;
  std::vector<std::byte> packed_;
  ZstdPack pack_;
};

}  // namespace kerf
