// SPDX-License-Identifier: Apache-2.0
#include "server/pictures/picture_cache.h"

#include <algorithm>
#include <exception>
#include <utility>

namespace kerf::net {

/// An entry in the list of pictures being made, removed by its destructor.
class PictureCache::Turn {
 public:
  /// Call with the mutex of the cache held.
  Turn(PictureCache& cache, Making making)
      : cache_(cache), at_(cache.making_.insert(cache.making_.end(), std::move(making))) {}
  ~Turn() {
    const std::lock_guard lock(cache_.mutex_);
    cache_.making_.erase(at_);
  }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;

 private:
  PictureCache& cache_;
  std::list<Making>::iterator at_;
};

PictureCache::PictureCache(std::filesystem::path folder, std::chrono::milliseconds pause,
                           std::function<Clock::time_point()> now)
    : files_(std::move(folder)), pause_(pause), now_(std::move(now)) {}

std::expected<PictureCache::Picture, MakeError> PictureCache::get(
    const std::string& name, const std::function<Present()>& present, const std::stop_token& gone) {
  std::promise<Present> asked;
  Making making{name, {}, {}};
  std::optional<Turn> turn;
  {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find(entries_, name, &Entry::name);
    if (found != entries_.end()) {
      if (now_() - found->made_at < pause_) return found->picture;
      making.newest = found->picture;
    }
    const auto other = std::ranges::find(making_, name, &Making::name);
    if (other != making_.end()) {
      making = *other;
    } else {
      making.state = asked.get_future().share();
      turn.emplace(*this, making);
    }
  }
  if (!turn) return make(making, gone);
  try {
    asked.set_value(present());
  } catch (...) {
    asked.set_exception(std::current_exception());
  }
  auto picture = make(making, gone);
  if (picture) keep(name, *picture);
  return picture;
}

/// Calls for the same state share the file of DownloadCache.
std::expected<PictureCache::Picture, MakeError> PictureCache::make(const Making& making,
                                                                   const std::stop_token& gone) {
  const Present& state = making.state.get();
  if (making.newest && making.newest->tag == state.tag) return *making.newest;
  const auto file = files_.get(making.name + "/" + state.tag, state.make, gone);
  if (!file) return std::unexpected(file.error());
  return Picture{state.tag, *file};
}

void PictureCache::keep(const std::string& name, const Picture& picture) {
  const std::lock_guard lock(mutex_);
  std::erase_if(entries_, [&](const Entry& entry) { return entry.name == name; });
  entries_.push_front({name, picture, now_()});
  if (entries_.size() > kPicturesMax) entries_.pop_back();
}

}  // namespace kerf::net
