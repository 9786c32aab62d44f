// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/record/mcap_writer.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "haptic_agent/new_file.h"
#include "server/store/crc32.h"

namespace kerf::agent::mcap {
namespace {

constexpr std::uint16_t kSchemaId = 1;
constexpr std::uint16_t kChannelId = 1;
constexpr std::string_view kCompression = "zstd";
/// Size of a record's head: the operation code and the length of the content.
constexpr std::size_t kHeadBytes = 1 + sizeof(std::uint64_t);

}  // namespace

/// Appends a record with the content that `fill` writes.
template <typename Fill>
void McapWriter::record(Bytes& out, Op op, const Fill& fill) {
  ByteWriter to(out);
  to.number(static_cast<std::uint8_t>(op));
  const std::size_t at = out.size();
  to.number(std::uint64_t{0});
  fill(to);
  const std::uint64_t length = out.size() - at - sizeof length;
  std::memcpy(out.data() + at, &length, sizeof length);
}

McapWriter::McapWriter(int file, std::string path, ChannelType type)
    : file_(file), path_(std::move(path)), type_(std::move(type)) {}

McapWriter::McapWriter(McapWriter&& other) noexcept
    : file_(std::exchange(other.file_, -1)),
      path_(std::move(other.path_)),
      type_(std::move(other.type_)),
      pack_(std::move(other.pack_)),
      error_(std::move(other.error_)),
      offset_(other.offset_),
      chunk_(std::move(other.chunk_)),
      index_(std::move(other.index_)),
      chunks_(std::move(other.chunks_)),
      places_(std::move(other.places_)),
      messages_(other.messages_),
      start_ns_(other.start_ns_),
      end_ns_(other.end_ns_) {}

McapWriter::~McapWriter() {
  if (file_ >= 0) ::close(file_);
}

std::expected<McapWriter, std::string> McapWriter::create(const std::string& path,
                                                          const ChannelType& type) {
  const auto file = new_file(path);
  if (!file) return std::unexpected(file.error());
  McapWriter writer(*file, path, type);
  Bytes start;
  ByteWriter(start).raw(std::as_bytes(std::span(kMagic)));
  record(start, Op::kHeader, [](ByteWriter& to) {
    to.text("ros2");
    to.text("kerf-agent");
  });
  writer.schema(start);
  writer.channel(start);
  if (!writer.put(start)) return std::unexpected(writer.error());
  return writer;
}

bool McapWriter::put(const Bytes& bytes) {
  if (!error_.empty()) return false;
  std::span<const std::byte> left(bytes);
  while (!left.empty()) {
    const ssize_t written = ::write(file_, left.data(), left.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      error_ = "cannot write " + path_ + ": " + std::strerror(errno);
      return false;
    }
    left = left.subspan(static_cast<std::size_t>(written));
  }
  offset_ += bytes.size();
  return true;
}

void McapWriter::schema(Bytes& out) const {
  record(out, Op::kSchema, [this](ByteWriter& to) {
    to.number(kSchemaId);
    to.text(type_.schema_name);
    to.text(type_.schema_encoding);
    to.text(type_.schema);
  });
}

void McapWriter::channel(Bytes& out) const {
  record(out, Op::kChannel, [this](ByteWriter& to) {
    to.number(kChannelId);
    to.number(kSchemaId);
    to.text(type_.topic);
    to.text(type_.message_encoding);
    to.texts({});
  });
}

void McapWriter::message(std::uint32_t sequence, std::uint64_t time_ns,
                         std::span<const std::byte> data) {
  index_.emplace_back(time_ns, chunk_.size());
  record(chunk_, Op::kMessage, [&](ByteWriter& to) {
    to.number(kChannelId);
    to.number(sequence);
    to.number(time_ns);
    to.number(time_ns);
    to.raw(data);
  });
}

bool McapWriter::write_chunk() {
  if (index_.empty()) return error_.empty();
  const auto packed = pack_.pack(chunk_);  // about 1 ms for a second of ticks
  const auto [first, last] = std::ranges::minmax_element(index_);
  ChunkPlace place{.start_ns = first->first,
                   .end_ns = last->first,
                   .offset = offset_,
                   .length = 0,
                   .index_offset = 0,
                   .index_length = 0,
                   .compressed = packed.size(),
                   .uncompressed = chunk_.size()};
  out_.clear();
  record(out_, Op::kChunk, [&](ByteWriter& to) {
    to.number(place.start_ns);
    to.number(place.end_ns);
    to.number(place.uncompressed);
    to.number(crc32(chunk_));
    to.text(kCompression);
    to.number(place.compressed);
    to.raw(packed);
  });
  place.length = out_.size();
  place.index_offset = offset_ + out_.size();
  record(out_, Op::kMessageIndex, [&](ByteWriter& to) {
    to.number(kChannelId);
    to.number(static_cast<std::uint32_t>(index_.size() * 2 * sizeof(std::uint64_t)));
    for (const auto& [time_ns, at] : index_) {
      to.number(time_ns);
      to.number(at);
    }
  });
  place.index_length = out_.size() - place.length;
  const bool done = put(out_);
  if (done) {
    start_ns_ = messages_ == 0 ? place.start_ns : std::min(start_ns_, place.start_ns);
    end_ns_ = std::max(end_ns_, place.end_ns);
    messages_ += index_.size();
    chunks_.push_back(place);
  }
  chunk_.clear();
  index_.clear();
  return done;
}

bool McapWriter::metadata(const std::string& name, const Texts& texts) {
  Bytes out;
  record(out, Op::kMetadata, [&](ByteWriter& to) {
    to.text(name);
    to.texts(texts);
  });
  places_.push_back({Op::kMetadataIndex, offset_, out.size(), 0, 0, name, {}});
  return put(out);
}

bool McapWriter::attachment(const std::string& name, const std::string& media_type,
                            std::uint64_t time_ns, std::string_view data) {
  Bytes out;
  record(out, Op::kAttachment, [&](ByteWriter& to) {
    to.number(time_ns);
    to.number(time_ns);
    to.text(name);
    to.text(media_type);
    to.number(std::uint64_t{data.size()});
    to.raw(std::as_bytes(std::span(data)));
    to.number(crc32(std::span(out).subspan(kHeadBytes)));
  });
  places_.push_back(
      {Op::kAttachmentIndex, offset_, out.size(), time_ns, data.size(), name, media_type});
  return put(out);
}

void McapWriter::statistics(Bytes& out) const {
  const auto count = [this](Op op) {
    return static_cast<std::uint32_t>(
        std::ranges::count_if(places_, [op](const Place& place) { return place.op == op; }));
  };
  record(out, Op::kStatistics, [&](ByteWriter& to) {
    to.number(messages_);
    to.number(std::uint16_t{1});  // schemas
    to.number(std::uint32_t{1});  // channels
    to.number(count(Op::kAttachmentIndex));
    to.number(count(Op::kMetadataIndex));
    to.number(static_cast<std::uint32_t>(chunks_.size()));
    to.number(start_ns_);
    to.number(end_ns_);
    to.number(static_cast<std::uint32_t>(sizeof kChannelId + sizeof messages_));
    to.number(kChannelId);
    to.number(messages_);
  });
}

void McapWriter::chunk_indexes(Bytes& out) const {
  for (const ChunkPlace& chunk : chunks_) {
    record(out, Op::kChunkIndex, [&chunk](ByteWriter& to) {
      to.number(chunk.start_ns);
      to.number(chunk.end_ns);
      to.number(chunk.offset);
      to.number(chunk.length);
      to.number(static_cast<std::uint32_t>(sizeof kChannelId + sizeof chunk.index_offset));
      to.number(kChannelId);
      to.number(chunk.index_offset);
      to.number(chunk.index_length);
      to.text(kCompression);
      to.number(chunk.compressed);
      to.number(chunk.uncompressed);
    });
  }
}

void McapWriter::place_indexes(Bytes& out, Op op) const {
  for (const Place& place : places_) {
    if (place.op != op) continue;
    record(out, op, [&place, op](ByteWriter& to) {
      to.number(place.offset);
      to.number(place.length);
      if (op == Op::kAttachmentIndex) {
        to.number(place.time_ns);
        to.number(place.time_ns);
        to.number(place.data_bytes);
      }
      to.text(place.name);
      if (op == Op::kAttachmentIndex) to.text(place.media_type);
    });
  }
}

/// Returns the summary section, the offsets of its groups, and the footer, for a summary at
/// `offset_`.
Bytes McapWriter::summary() const {
  struct Group {
    Op op;
    std::uint64_t start, length;
  };
  Bytes out;
  std::vector<Group> groups;
  const auto group = [&](Op op, const auto& write) {
    const std::size_t start = out.size();
    write();
    if (out.size() > start) groups.push_back({op, offset_ + start, out.size() - start});
  };
  group(Op::kSchema, [&] { schema(out); });
  group(Op::kChannel, [&] { channel(out); });
  group(Op::kStatistics, [&] { statistics(out); });
  group(Op::kChunkIndex, [&] { chunk_indexes(out); });
  group(Op::kAttachmentIndex, [&] { place_indexes(out, Op::kAttachmentIndex); });
  group(Op::kMetadataIndex, [&] { place_indexes(out, Op::kMetadataIndex); });
  const std::uint64_t offsets_start = offset_ + out.size();
  for (const Group& one : groups) {
    record(out, Op::kSummaryOffset, [&one](ByteWriter& to) {
      to.number(static_cast<std::uint8_t>(one.op));
      to.number(one.start);
      to.number(one.length);
    });
  }
  record(out, Op::kFooter, [&](ByteWriter& to) {
    to.number(offset_);
    to.number(offsets_start);
    to.number(std::uint32_t{0});
  });
  // The CRC covers the summary and the footer up to itself.
  const std::uint32_t crc = crc32(std::span(out).first(out.size() - sizeof crc));
  std::memcpy(out.data() + out.size() - sizeof crc, &crc, sizeof crc);
  return out;
}

bool McapWriter::finish() {
  write_chunk();
  Bytes end;
  record(end, Op::kDataEnd, [](ByteWriter& to) { to.number(std::uint32_t{0}); });
  if (!put(end)) return false;
  Bytes out = summary();
  ByteWriter(out).raw(std::as_bytes(std::span(kMagic)));
  return put(out);
}

}  // namespace kerf::agent::mcap
