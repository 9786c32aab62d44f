// SPDX-License-Identifier: Apache-2.0
#include "server/http/picture_cache.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace kerf::net {

PictureCache::PictureCache(std::filesystem::path folder, std::chrono::milliseconds pause)
    : files_(std::move(folder)), pause_(pause) {}

std::expected<PictureCache::Picture, MakeError> PictureCache::get(
    const std::string& name, const std::function<Present()>& present, const std::stop_token& gone) {
  const auto now = Clock::now();
  std::optional<Picture> newest;
  {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find(entries_, name, &Entry::name);
    if (found != entries_.end()) {
      if (now - found->shown_at < pause_) return found->picture;
      newest = found->picture;
    }
  }
  const Present state = present();
  Picture picture{state.tag, nullptr};
  if (newest && newest->tag == state.tag) {
    picture = *newest;
  } else {
    const auto file = files_.get(name + "/" + state.tag, state.make, gone);
    if (!file) return std::unexpected(file.error());
    picture.file = *file;
  }
  keep(name, picture, now);
  return picture;
}

void PictureCache::keep(const std::string& name, const Picture& picture, Clock::time_point at) {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find(entries_, name, &Entry::name);
  if (found != entries_.end()) {
    if (found->shown_at > at) return;
    entries_.erase(found);
  }
  entries_.push_front({name, picture, at});
  if (entries_.size() > kPicturesMax) entries_.pop_back();
}

}  // namespace kerf::net
