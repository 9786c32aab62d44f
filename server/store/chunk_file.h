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

/// Longest chunk before it is compressed; readers reserve no more memory than that for a file that
/// states more. A snapshot's chunk of tiles is at most 1 MB and one tile, whose 1024 columns may
/// have 4,000 elements of 16 bytes each; its head may have 500,000 poses of tools and users.
inline constexpr std::size_t kChunkBytesMax = std::size_t{64} << 20;

/// The file that a ChunkWriter of `file` writes until it has finished; a process that is killed
/// leaves it.
std::filesystem::path unfinished_file(const std::filesystem::path& file);

/// Writes a file of compressed chunks with checksums (README.md, "Snapshots"), in place of the one
/// of that name: the present one stays until finish() has succeeded.
class ChunkWriter {
 public:
  ChunkWriter(std::filesystem::path file, std::uint32_t version);
  ChunkWriter(const ChunkWriter&) = delete;
  ChunkWriter& operator=(const ChunkWriter&) = delete;
  /// Removes what has not been finished.
  ~ChunkWriter();

  /// Appends a chunk of 1 byte to kChunkBytesMax; a longer one is an error. After an error it does
  /// nothing.
  void write(std::span<const std::byte> chunk);
  /// Synchronizes the file with the disk and renames it; the present one gets the name `keep_as`,
  /// unless that is empty. Returns its size, or what failed, as one sentence.
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
  /// Reads the contents of such a file.
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
