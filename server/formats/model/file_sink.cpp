// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/file_sink.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

namespace kerf {
namespace {

// A multiple of 12: chunks never split spooled words of 4 bytes or triples of 12 bytes.
constexpr std::size_t kChunkBytes = std::size_t{12} * 65536;
constexpr std::size_t kBufferBytes = std::size_t{1} << 18;

std::filesystem::path spool_path(const std::filesystem::path& beside) {
  return beside.string() + ".spool";
}

}  // namespace

FileSink::FileSink(const std::filesystem::path& path) : file_(std::fopen(path.c_str(), "wb")) {
  if (!file_) {
    error_ = errno;
    return;
  }
  std::setvbuf(file_.get(), nullptr, _IOFBF, kBufferBytes);
}

void FileSink::note_error() {
  if (error_ == 0) error_ = errno != 0 ? errno : EIO;
}

void FileSink::write(std::span<const std::byte> bytes) {
  if (!ok()) return;
  errno = 0;
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size()) note_error();
  bytes_ += bytes.size();
}

void FileSink::patch(std::uint64_t offset, std::span<const std::byte> bytes) {
  if (!ok()) return;
  errno = 0;
  const bool done = std::fseek(file_.get(), static_cast<long>(offset), SEEK_SET) == 0 &&
                    std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) == bytes.size() &&
                    std::fseek(file_.get(), 0, SEEK_END) == 0;
  if (!done) note_error();
}

std::expected<void, std::string> FileSink::finish() {
  errno = 0;
  if (file_ && std::fflush(file_.get()) != 0) note_error();
  if (ok()) return {};
  return std::unexpected(std::string(std::strerror(error_)));
}

SpoolFile::SpoolFile(const std::filesystem::path& beside) : sink_(spool_path(beside)) {
  const std::filesystem::path path = spool_path(beside);
  if (!sink_.ok()) return;
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
}

SpoolFile::~SpoolFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool SpoolFile::rewind() {
  read_ = 0;
  if (!chunk_) chunk_ = std::make_unique_for_overwrite<std::byte[]>(kChunkBytes);
  return sink_.finish().has_value() && descriptor_ >= 0;
}

std::span<const std::byte> SpoolFile::read_chunk() {
  std::size_t filled = 0;
  while (filled < kChunkBytes) {
    const ssize_t count = ::pread(descriptor_, chunk_.get() + filled, kChunkBytes - filled,
                                  static_cast<off_t>(read_ + filled));
    if (count <= 0) break;
    filled += static_cast<std::size_t>(count);
  }
  read_ += filled;
  return {chunk_.get(), filled};
}

}  // namespace kerf
