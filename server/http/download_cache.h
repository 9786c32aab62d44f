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

/// A file open for reading, possibly unlinked.
class OpenFile {
 public:
  static std::expected<std::shared_ptr<const OpenFile>, std::string> open(
      const std::filesystem::path& path, std::string note = {});
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  std::uint64_t bytes() const { return bytes_; }
  /// The note made with the file; may be empty.
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
  bool impossible = false;  ///< the request cannot be met; otherwise the server failed
  bool no_space = false;    ///< the disk space is reserved for sessions
};

/// The note of a finished file (OpenFile::note), or the error.
using MadeFile = std::expected<std::string, MakeError>;

/// Makes files for downloads on demand: one per key, shared by all requests for it. They are
/// unlinked, so none is left behind. Unlike with a stream, the length is known before the first
/// byte, and a slow client occupies neither a thread nor memory. Thread-safe.
class DownloadCache {
 public:
  /// `folder` should hold nothing else. Deletes numbered files that a crash left in it.
  explicit DownloadCache(std::filesystem::path folder);
  using File = std::expected<std::shared_ptr<const OpenFile>, MakeError>;
  using Progress = std::function<void(double)>;  ///< receives the completed share, 0 to 1
  using Make = std::function<MadeFile(const std::filesystem::path&, const Progress&,
                                      const std::stop_token&)>;
  /// Returns the file for `key`, written by `make` unless it exists. Blocks while another call
  /// writes the same file. `make` is asked to stop by stop(), and once all calls for the file have
  /// been asked to by their `gone`. A waiting call ends with its own `gone`.
  File get(const std::string& key, const Make& make, const std::stop_token& gone = {});
  /// Asks all writers to stop. Later calls of get() write nothing.
  void stop();
  /// Frees the disk for another use, named by `reason`: drops the kept files and asks all writers
  /// to stop. get() writes nothing until this is called with nullopt.
  void keep_free(std::optional<std::string> reason);

  /// A file that is being written.
  struct Making {
    std::string key;
    double share = 0;    ///< completed, 0 to 1
    double seconds = 0;  ///< since its start
  };
  /// Returns the files being written whose key starts with `prefix`.
  std::vector<Making> making(std::string_view prefix) const;
  /// Returns the number of get() calls that want the file being written for `key`.
  int waiting(std::string_view key) const;

 private:
  static constexpr std::size_t kFilesMax = 16;
  /// Bytes of kept files, not counting the newest. They are unlinked, so an operator who searches a
  /// full disk does not see them.
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
    std::optional<File> file;  ///< set once the file is finished or has failed
    std::stop_source stop;
    std::atomic<int> wanted = 1;  ///< number of get() calls not yet asked to stop
  };
  /// Waits until the file is finished or `gone` is requested; counts as a call that wants the file.
  static File wait(const std::shared_ptr<Job>& job, const std::stop_token& gone);
  File make_file(Job& job, const std::filesystem::path& path, const Make& make);
  void keep(const std::string& key, const std::shared_ptr<const OpenFile>& file);

  std::filesystem::path folder_;
  mutable std::mutex mutex_;
  std::list<Entry> entries_;  ///< newest first
  std::list<std::shared_ptr<Job>> jobs_;
  std::uint64_t last_ = 0;
  bool stopped_ = false;
  std::optional<std::string> needed_;  ///< why the disk is reserved, if it is
};

}  // namespace kerf::net
