#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <string>

namespace kerf::net {

/// A file that is open for reading; it may have no name any more.
class OpenFile {
 public:
  static std::expected<std::shared_ptr<const OpenFile>, std::string> open(
      const std::filesystem::path& path);
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  std::uint64_t bytes() const { return bytes_; }
  /// Reads up to `size` bytes at `offset`; 0 at the end or on an error. Any number of threads.
  std::size_t read(std::uint64_t offset, char* to, std::size_t size) const;

 private:
  OpenFile(int descriptor, std::uint64_t bytes) : descriptor_(descriptor), bytes_(bytes) {}
  int descriptor_;
  std::uint64_t bytes_;
};

/// Files made on demand for downloads: written once per state, then served to anybody who asks for
/// the same. They have no name on the disk, so none is left behind. Writing to a file rather than
/// into the socket means that a slow client holds neither a thread nor memory, and that the length
/// is known before the first byte.
class DownloadCache {
 public:
  explicit DownloadCache(std::filesystem::path folder);
  using Make = std::function<std::expected<void, std::string>(const std::filesystem::path&)>;
  /// The file for `key`; `make` writes it if nobody has yet.
  std::expected<std::shared_ptr<const OpenFile>, std::string> get(const std::string& key,
                                                                  const Make& make);

 private:
  static constexpr std::size_t kFilesMax = 16;
  struct Entry {
    std::string key;
    std::shared_ptr<const OpenFile> file;
  };
  std::filesystem::path folder_;
  std::mutex mutex_;
  std::list<Entry> entries_;  ///< newest first
  std::uint64_t last_ = 0;
};

}  // namespace kerf::net
