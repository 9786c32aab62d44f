// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <expected>
#include <filesystem>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>

#include "server/http/download_cache.h"

namespace kerf::net {

/// The newest picture of each session and size, at most 64. While a block changes, a picture is
/// made no more often than every `pause`, however many ask. Thread-safe.
class PictureCache {
 public:
  explicit PictureCache(std::filesystem::path folder,
                        std::chrono::milliseconds pause = std::chrono::seconds(2));
  struct Picture {
    std::string tag;  ///< of the state that it shows
    std::shared_ptr<const OpenFile> file;
  };
  /// The present state, and what writes its picture.
  struct Present {
    std::string tag;
    DownloadCache::Make make;
  };
  /// Returns the picture `name`. `present` is called unless the newest one is younger than the
  /// pause. Stops as DownloadCache::get does.
  std::expected<Picture, MakeError> get(const std::string& name,
                                        const std::function<Present()>& present,
                                        const std::stop_token& gone = {});
  /// Asks all pictures that are being made to stop. Later calls of get() make none.
  void stop() { files_.stop(); }

 private:
  static constexpr std::size_t kPicturesMax = 64;
  using Clock = std::chrono::steady_clock;
  struct Entry {
    std::string name;
    Picture picture;
    Clock::time_point shown_at;  ///< the block was in that state
  };
  void keep(const std::string& name, const Picture& picture, Clock::time_point at);

  DownloadCache files_;
  std::chrono::milliseconds pause_;
  std::mutex mutex_;          ///< guards entries_
  std::list<Entry> entries_;  ///< newest first
};

}  // namespace kerf::net
