// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/platform/clock.h"

namespace kerf::net {

/// A file that is open for reading; it may have been unlinked.
class OpenFile {
 public:
  static std::expected<std::shared_ptr<const OpenFile>, std::string> open(
      const std::filesystem::path& path, std::string note = {});
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  std::uint64_t bytes() const { return bytes_; }
  /// What is stated with the file; may be empty.
  const std::string& note() const { return note_; }
  /// Reads up to `size` bytes at `offset` and returns their number; 0 at the end or on an error.
  /// Thread-safe.
  std::size_t read(std::uint64_t offset, char* to, std::size_t size) const;

 private:
  OpenFile(int descriptor, std::uint64_t bytes, std::string note)
      : descriptor_(descriptor), bytes_(bytes), note_(std::move(note)) {}
  int descriptor_;
  std::uint64_t bytes_;
  std::string note_;
};

/// The reason why a file could not be made.
struct MakeError {
  std::string reason;
  bool impossible = false;  ///< the request cannot be met; otherwise the server is at fault
  bool no_space = false;    ///< the disk is needed for sessions
};

/// The note of a file that was made (OpenFile::note), or why there is none.
using MadeFile = std::expected<std::string, MakeError>;

/// Files made on demand for downloads, written once per key and then shared by all requests for it.
/// They are unlinked, so none is left behind. A file instead of a stream means that a slow client
/// occupies neither a thread nor memory, and that the length is known before the first byte.
/// Thread-safe.
class DownloadCache {
 public:
  /// The folder should hold nothing else. Numbered files that a crash left in it are deleted.
  explicit DownloadCache(std::filesystem::path folder);
  using File = std::expected<std::shared_ptr<const OpenFile>, MakeError>;
  using Progress = std::function<void(double)>;  ///< receives the completed share, 0 to 1
  using Make = std::function<MadeFile(const std::filesystem::path&, const Progress&,
                                      const std::stop_token&)>;
  /// Returns the file for `key`; `make` writes it if it does not exist. Blocks while another call
  /// writes the same file. `make` is asked to stop once all calls for the file have been asked to
  /// (`gone`), and by stop(). A call that waits for another one ends with its own `gone`.
  File get(const std::string& key, const Make& make, const std::stop_token& gone = {});
  /// Asks all files that are being written to stop. Later calls of get() write none.
  void stop();
  /// The disk is needed for something else, for this reason: the files that are kept are let go,
  /// those that are being written are asked to stop, and get() writes none, until this is called
  /// with nothing.
  void keep_free(std::optional<std::string> reason);

  /// A file that is being written.
  struct Making {
    std::string key;
    double share = 0;    ///< completed, 0 to 1
    double seconds = 0;  ///< since its start
  };
  /// Returns the files being written whose key starts with `prefix`.
  std::vector<Making> making(std::string_view prefix) const;
  /// Returns how many calls of get() want the file that is being written for `key`.
  int waiting(std::string_view key) const;

 private:
  static constexpr std::size_t kFilesMax = 16;
  /// Bytes of the files that are kept, but for the newest one. They are unlinked, so an operator
  /// who looks for what fills the disk does not find them.
  static constexpr std::uint64_t kBytesMax = std::uint64_t{1} << 30;
  struct Entry {
    std::string key;
    std::shared_ptr<const OpenFile> file;
  };
  struct Job {
    std::string key;
    Clock::time_point start;
    std::atomic<double> share = 0;
    std::mutex mutex;  ///< guards the file
    std::condition_variable_any made;
    std::optional<File> file;  ///< once it has been made, or has failed
    std::stop_source stop;
    std::atomic<int> wanted = 1;  ///< calls of get() that have not been asked to stop
  };
  /// Waits as one of the calls that want the file, until it is made or `gone`.
  static File wait(const std::shared_ptr<Job>& job, const std::stop_token& gone);
  File make_file(Job& job, const std::filesystem::path& path, const Make& make);
  void keep(const std::string& key, const std::shared_ptr<const OpenFile>& file);

  std::filesystem::path folder_;
  mutable std::mutex mutex_;
  std::list<Entry> entries_;  ///< newest first
  std::list<std::shared_ptr<Job>> jobs_;
  std::uint64_t last_ = 0;
  bool stopped_ = false;
  std::optional<std::string> needed_;  ///< why the disk is needed for something else
};

}  // namespace kerf::net
