// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <expected>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace kerf {

/// A file written from front to back. The first error is kept and later writes do nothing, so that
/// callers check once, in finish().
class FileSink {
 public:
  /// Creates or truncates the file. ok() is false if that failed.
  explicit FileSink(const std::filesystem::path& path);

  void write(std::span<const std::byte> bytes);
  void write(std::string_view text) { write(std::as_bytes(std::span(text))); }
  /// Overwrites bytes written before. The next write() continues at the end.
  void patch(std::uint64_t offset, std::span<const std::byte> bytes);
  std::uint64_t bytes() const { return bytes_; }
  bool ok() const { return error_ == 0; }
  /// Flushes and closes. Returns the first error as one sentence.
  std::expected<void, std::string> finish();

 private:
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  void note_error();

  std::unique_ptr<std::FILE, Closer> file_;
  std::uint64_t bytes_ = 0;
  int error_ = 0;
};

/// Buffers bytes in an unnamed temporary file, so that late parts of a format need no memory while
/// earlier ones are written.
class SpoolFile {
 public:
  /// Creates the file in the folder of `beside`, on the disk of the model.
  explicit SpoolFile(const std::filesystem::path& beside);

  void write(std::span<const std::byte> bytes) { sink_.write(bytes); }
  std::uint64_t bytes() const { return sink_.bytes(); }
  /// Calls use(span) with all bytes in order, in chunks of a megabyte. Returns false if reading
  /// fails.
  template <class Use>
  bool read_all(Use&& use) {
    if (!rewind()) return false;
    for (;;) {
      const std::span<const std::byte> chunk = read_chunk();
      if (chunk.empty()) return whole();
      use(chunk);
    }
  }

 private:
  bool rewind();
  std::span<const std::byte> read_chunk();
  bool whole() const { return read_ == sink_.bytes(); }

  FileSink sink_;
  int descriptor_ = -1;
  std::unique_ptr<std::byte[]> chunk_;
  std::uint64_t read_ = 0;

 public:
  ~SpoolFile();
  SpoolFile(const SpoolFile&) = delete;
  SpoolFile& operator=(const SpoolFile&) = delete;
};

}  // namespace kerf
