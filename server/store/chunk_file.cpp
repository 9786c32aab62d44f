// SPDX-License-Identifier: Apache-2.0
#include "server/store/chunk_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <utility>

#include "server/store/byte_code.h"
#include "server/store/crc32.h"

namespace kerf {
namespace {

constexpr std::array<char, 8> kMagic = {'K', 'E', 'R', 'F', 'S', 'N', 'A', 'P'};
constexpr std::size_t kBeginBytes = kMagic.size() + sizeof(std::uint32_t);
constexpr std::size_t kChunkHeadBytes = 3 * sizeof(std::uint32_t);
constexpr mode_t kMode = 0600;  // only those who may watch the session may see the block

/// The checksum includes the number of the chunk and so detects reordering.
std::uint32_t chunk_checksum(std::uint64_t number, std::uint32_t size,
                             std::span<const std::byte> packed) {
  ByteWriter head;
  head.put(number);
  head.put(size);
  return crc32(packed, crc32(head.take()));
}

/// Makes a rename durable.
void sync_folder(const std::filesystem::path& folder) {
  const int descriptor = open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return;
  (void)fsync(descriptor);
  close(descriptor);
}

}  // namespace

std::filesystem::path unfinished_file(const std::filesystem::path& file) {
  return file.string() + ".tmp";
}

ChunkWriter::ChunkWriter(std::filesystem::path file, std::uint32_t version)
    : file_(std::move(file)), temporary_(unfinished_file(file_)) {
  descriptor_ = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kMode);
  if (descriptor_ < 0) {
    fail("cannot be created");
    return;
  }
  put(std::as_bytes(std::span(kMagic)));
  ByteWriter begin;
  begin.put(version);
  put(begin.take());
}

ChunkWriter::~ChunkWriter() {
  if (descriptor_ < 0) return;
  close(descriptor_);
  unlink(temporary_.c_str());
}

void ChunkWriter::fail(const char* what) {
  if (error_.empty()) error_ = temporary_.string() + " " + what + ": " + std::strerror(errno);
}

void ChunkWriter::put(std::span<const std::byte> bytes) {
  bytes_ += bytes.size();
  while (!bytes.empty() && error_.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return fail("cannot be written");
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void ChunkWriter::write(std::span<const std::byte> chunk) {
  if (!error_.empty()) return;
  if (chunk.size() > kChunkBytesMax) {
    error_ = "a part of the snapshot is too long";
    return;
  }
  const auto packed = pack_.pack(chunk);
  const auto size = static_cast<std::uint32_t>(chunk.size());
  ByteWriter head;
  head.put(size);
  head.put(static_cast<std::uint32_t>(packed.size()));
  head.put(chunk_checksum(chunks_++, size, packed));
  put(head.take());
  put(packed);
}

std::expected<std::uint64_t, std::string> ChunkWriter::finish(
    const std::filesystem::path& keep_as) {
  if (error_.empty() && fsync(descriptor_) != 0) fail("cannot be synchronized");
  // There may be no old file. If it cannot be kept, it is replaced.
  if (error_.empty() && !keep_as.empty()) (void)rename(file_.c_str(), keep_as.c_str());
  if (error_.empty() && rename(temporary_.c_str(), file_.c_str()) != 0) fail("cannot be renamed");
  if (!error_.empty()) return std::unexpected(error_);
  close(std::exchange(descriptor_, -1));
  sync_folder(file_.parent_path());
  return bytes_;
}

ChunkReader::ChunkReader(const std::filesystem::path& file, std::uint32_t version)
    : in_(std::make_unique<std::ifstream>(file, std::ios::binary)), version_(version) {
  std::error_code ignored;
  left_ = std::filesystem::file_size(file, ignored);
  if (ignored) left_ = 0;
}

ChunkReader::ChunkReader(std::string contents, std::uint32_t version)
    : version_(version), left_(contents.size()) {
  in_ = std::make_unique<std::istringstream>(std::move(contents));
}

bool ChunkReader::read(std::span<std::byte> bytes) {
  if (bytes.size() > left_) return false;
  in_->read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  left_ -= bytes.size();
  return in_->good();
}

std::expected<std::span<const std::byte>, std::string> ChunkReader::next() {
  if (chunks_ == 0) {
    std::array<std::byte, kBeginBytes> begin{};
    if (!read(begin) || std::memcmp(begin.data(), kMagic.data(), kMagic.size()) != 0) {
      return std::unexpected("it is not a snapshot of Kerf");
    }
    const auto version = ByteReader(std::span(begin).subspan(kMagic.size())).get<std::uint32_t>();
    if (version != version_) {
      return std::unexpected("it is of version " + std::to_string(version) + " of its format");
    }
  }
  std::array<std::byte, kChunkHeadBytes> head{};
  if (!read(head)) return std::unexpected("it is truncated");
  ByteReader fields(head);
  const auto size = fields.get<std::uint32_t>(), packed_size = fields.get<std::uint32_t>();
  const auto checksum = fields.get<std::uint32_t>();
  if (size > kChunkBytesMax) return std::unexpected("it states a chunk that is too long");
  if (packed_size > left_) return std::unexpected("it is truncated");
  packed_.resize(packed_size);
  if (!read(packed_)) return std::unexpected("it cannot be read");
  if (chunk_checksum(chunks_++, size, packed_) != checksum) {
    return std::unexpected("a checksum is wrong");
  }
  const auto chunk = pack_.unpack(packed_, size);
  if (!chunk) return std::unexpected("it is damaged");
  return *chunk;
}

}  // namespace kerf
