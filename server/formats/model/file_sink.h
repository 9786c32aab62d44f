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

/// A file that is written from front to back. An error sticks: writers write on and the caller asks
/// once, at the end.
class FileSink {
 public:
  /// Creates or empties the file; ok() says whether that worked.
  explicit FileSink(const std::filesystem::path& path);

  void write(std::span<const std::byte> bytes);
  void write(std::string_view text) { write(std::as_bytes(std::span(text))); }
  /// Overwrites what has been written before; the next write goes on at the end.
  void patch(std::uint64_t offset, std::span<const std::byte> bytes);
  std::uint64_t bytes() const { return bytes_; }
  bool ok() const { return error_ == 0; }
  /// Hands everything to the system; what went wrong since the beginning, as one sentence.
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

/// Bytes that a format wants behind others that are produced at the same time: they wait in a
/// file without a name, so that they need no memory.
class SpoolFile {
 public:
  /// In the folder of `beside`, where there is room for the model itself.
  explicit SpoolFile(const std::filesystem::path& beside);

  void write(std::span<const std::byte> bytes) { sink_.write(bytes); }
  std::uint64_t bytes() const { return sink_.bytes(); }
  /// Calls use(span) with all bytes, in order, a megabyte at a time.
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
