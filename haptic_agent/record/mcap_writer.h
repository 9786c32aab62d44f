// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptic_agent/record/byte_writer.h"
#include "server/store/zstd_pack.h"

namespace kerf::agent::mcap {

/// Operation codes of the records (https://mcap.dev/spec).
enum class Op : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

inline constexpr std::string_view kMagic = "\x89MCAP0\r\n";

/// The only channel of a file, and the type of its messages.
struct ChannelType {
  std::string topic;
  std::string message_encoding;
  std::string schema_name;
  std::string schema_encoding;
  std::string schema;
};

/// Writes an MCAP file with one channel. Messages are in chunks, compressed by Zstandard and with a
/// CRC-32, each followed by its index; statistics, indexes and a footer are at the end. A full
/// chunk is written at once by one system call, so the file of a killed program is complete up to
/// its last chunk.
class McapWriter {
 public:
  /// Creates the file. Fails if it exists, so that no recording is overwritten. The error is one
  /// sentence without its full stop.
  static std::expected<McapWriter, std::string> create(const std::string& path,
                                                       const ChannelType& type);
  McapWriter(McapWriter&&) noexcept;
  McapWriter& operator=(McapWriter&&) = delete;
  ~McapWriter();

  /// Appends a message to the chunk. `time_ns`: since 1970 in UTC.
  void message(std::uint32_t sequence, std::uint64_t time_ns, std::span<const std::byte> data);
  /// Total size of the messages that `write_chunk` will write.
  std::size_t waiting_bytes() const noexcept { return chunk_.size(); }

  // Each returns false after a failed write (`error`), and then writes nothing more.
  bool write_chunk();
  bool metadata(const std::string& name, const Texts& texts);
  bool attachment(const std::string& name, const std::string& media_type, std::uint64_t time_ns,
                  std::string_view data);
  /// Writes the last chunk, the summary and the footer.
  bool finish();

  /// Why a write failed, as one sentence without its full stop. Empty if none failed.
  const std::string& error() const noexcept { return error_; }
  std::uint64_t messages() const noexcept { return messages_; }
  /// Size of the file so far.
  std::uint64_t bytes() const noexcept { return offset_; }

 private:
  struct ChunkPlace {
    std::uint64_t start_ns, end_ns, offset, length, index_offset, index_length;
    std::uint64_t compressed, uncompressed;
  };
  /// Position of an attachment or of metadata in the file.
  struct Place {
    Op op;
    std::uint64_t offset, length, time_ns, data_bytes;
    std::string name, media_type;
  };

  McapWriter(int file, std::string path, ChannelType type);
  template <typename Fill>
  static void record(Bytes& out, Op op, const Fill& fill);
  void schema(Bytes& out) const;
  void channel(Bytes& out) const;
  void statistics(Bytes& out) const;
  void chunk_indexes(Bytes& out) const;
  void place_indexes(Bytes& out, Op op) const;
  Bytes summary() const;
  bool put(const Bytes& bytes);

  int file_;
  std::string path_;
  ChannelType type_;
  ZstdPack pack_;
  std::string error_;
  std::uint64_t offset_ = 0;
  Bytes chunk_, out_;
  /// Time and offset within the chunk of each message.
  std::vector<std::pair<std::uint64_t, std::uint64_t>> index_;
  std::vector<ChunkPlace> chunks_;
  std::vector<Place> places_;
  std::uint64_t messages_ = 0, start_ns_ = 0, end_ns_ = 0;
};

}  // namespace kerf::agent::mcap
