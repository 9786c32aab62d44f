// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <expected>
#include <filesystem>
#include <functional>
#include <future>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>

#include "server/http/download_cache.h"
#include "server/platform/clock.h"

namespace kerf::net {

/// The newest picture of each session and size, at most 64. While a block changes, a picture is
/// made at most once per `pause` after the last one, however many clients ask. Thread-safe.
class PictureCache {
 public:
  explicit PictureCache(std::filesystem::path folder,
                        std::chrono::milliseconds pause = std::chrono::seconds(2),
                        std::function<Clock::time_point()> now = Clock::now);
  struct Picture {
    std::string tag;  ///< of the state shown
    std::shared_ptr<const OpenFile> file;
  };
  /// The current state and the writer of its picture.
  struct Present {
    std::string tag;
    DownloadCache::Make make;
  };
  /// Returns the picture `name`: the newest one until its pause is over, else the one that another
  /// call is making. If there is none, calls `present` and makes it. Stops as DownloadCache::get
  /// does.
  std::expected<Picture, MakeError> get(const std::string& name,
                                        const std::function<Present()>& present,
                                        const std::stop_token& gone = {});
  /// Asks all writers to stop. Later calls of get() make nothing.
  void stop() { files_.stop(); }

 private:
  static constexpr std::size_t kPicturesMax = 64;
  struct Entry {
    std::string name;
    Picture picture;
    Clock::time_point made_at;  ///< when it was finished
  };
  /// A picture being made, of the state that its first call has requested.
  struct Making {
    std::string name;
    std::shared_future<Present> state;
    std::optional<Picture> newest;  ///< the previous picture
  };
  class Turn;
  std::expected<Picture, MakeError> make(const Making& making, const std::stop_token& gone);
  void keep(const std::string& name, const Picture& picture);

  DownloadCache files_;
  std::chrono::milliseconds pause_;
  std::function<Clock::time_point()> now_;
  std::mutex mutex_;          ///< guards entries_ and making_
  std::list<Entry> entries_;  ///< newest first
  std::list<Making> making_;
};

}  // namespace kerf::net
