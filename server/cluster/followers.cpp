// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/followers.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <nlohmann/json.hpp>
#include <utility>

#include "server/store/write_fence.h"

namespace kerf {
namespace {

using Json = nlohmann::json;
using std::chrono::milliseconds;

constexpr std::string_view kSubject = "kerf.follow.";
constexpr milliseconds kNote{1000};
/// Time after which an unwatched session is no longer followed, and until a failed following is
/// retried.
constexpr std::int64_t kUnusedNs = 30'000'000'000, kFollowRetryNs = 5'000'000'000;
/// Time for a follower to get the rest of a copy. The owner is gone, so nothing is added.
constexpr milliseconds kFinish{1000};

}  // namespace

std::optional<Follow> parse_follow(std::string_view name) {
  if (name == "none") return Follow::kNone;
  if (name == "viewed") return Follow::kViewed;
  if (name == "all") return Follow::kAll;
  if (name == "only") return Follow::kOnly;
  return std::nullopt;
}

std::vector<std::byte> encode_follow(const FollowNote& note) {
  const std::string text = Json{{"node", note.node}, {"viewers", note.viewers}}.dump();
  std::vector<std::byte> bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

std::optional<FollowNote> decode_follow(std::span<const std::byte> bytes) {
  const auto* text = reinterpret_cast<const char*>(bytes.data());
  try {
    const Json json = Json::parse(text, text + bytes.size());
    return FollowNote{json.at("node").get<std::string>(), json.at("viewers").get<std::size_t>()};
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

std::string follow_subject(const std::string& session) { return std::string(kSubject) + session; }

std::optional<std::string> followed_by_subject(std::string_view subject) {
  if (!subject.starts_with(kSubject)) return std::nullopt;
  return std::string(subject.substr(kSubject.size()));
}

Followers::Followers(NatsConnection& nats, SessionRegistry& registry, std::string node,
                     Follow policy)
    : nats_(nats),
      registry_(registry),
      node_(std::move(node)),
      policy_(policy),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

Followers::~Followers() { stop(); }

void Followers::stop() {
  thread_ = {};
  std::map<std::string, Followed> ended;
  {
    const std::lock_guard lock(mutex_);
    has_stopped_ = true;
    std::swap(ended, followed_);
  }
  for (auto& [id, one] : ended) end(id, std::move(one.follower), "the server is shutting down");
}

void Followers::end(const std::string& session, std::unique_ptr<CopyFollower> follower,
                    const std::string& reason) {
  follower.reset();
  registry_.end_following(session, reason);
}

bool Followers::want(const std::string& session) {
  if (policy_ == Follow::kNone) return false;
  const std::int64_t now = Clock::boot_ns();
  const std::lock_guard lock(mutex_);
  if (has_stopped_) return false;
  auto [found, is_new] = followed_.try_emplace(session);
  Followed& one = found->second;
  one.wanted_ns = now;
  if (is_new) one.begun_ns = now;
  if (is_new) one.follower = std::make_unique<CopyFollower>(nats_, registry_, session, node_);
  return one.follower != nullptr && one.follower->state() != CopyFollower::State::kFailed;
}

bool Followers::is_following(const std::string& session) const {
  const std::lock_guard lock(mutex_);
  const auto found = followed_.find(session);
  return found != followed_.end() && found->second.follower != nullptr &&
         found->second.follower->state() == CopyFollower::State::kFollows;
}

void Followers::set_elsewhere(const std::vector<std::string>& sessions,
                              const std::vector<std::string>& taken, std::int64_t known_ns) {
  if (policy_ == Follow::kAll) {
    for (const std::string& id : sessions) (void)want(id);
  }
  const auto is_in = [](const std::vector<std::string>& list, const std::string& id) {
    return std::ranges::find(list, id) != list.end();
  };
  std::map<std::string, std::unique_ptr<CopyFollower>> gone;
  {
    const std::lock_guard lock(mutex_);
    for (auto one = followed_.begin(); one != followed_.end();) {
      const bool is_newer = one->second.begun_ns >= known_ns;
      if (is_newer || is_in(sessions, one->first) || is_in(taken, one->first)) {
        ++one;
      } else {
        gone.emplace(one->first, std::move(one->second.follower));
        one = followed_.erase(one);
      }
    }
  }
  for (auto& [id, follower] : gone) end(id, std::move(follower), "the session has ended");
}

bool Followers::finish(const std::string& session) {
  std::unique_ptr<CopyFollower> follower;
  {
    const std::lock_guard lock(mutex_);
    const auto found = followed_.find(session);
    if (found == followed_.end()) return false;
    follower = std::move(found->second.follower);
    followed_.erase(found);
  }
  const bool has_all = follower && follower->finish(kFinish);
  end(session, std::move(follower), "the session goes on at this server");
  return has_all;
}

/// Returns the failed ones, and those unwatched for a while.
std::vector<std::string> Followers::unused() {
  const std::int64_t now = Clock::boot_ns();
  std::vector<std::string> ids;
  const std::lock_guard lock(mutex_);
  for (auto& [id, one] : followed_) {
    const bool has_failed =
        one.follower != nullptr && one.follower->state() == CopyFollower::State::kFailed;
    if (has_failed && one.failed_ns == 0) one.failed_ns = now;
    const auto session = registry_.find_followed(id);
    if (session && session->figures().participants > 0) one.wanted_ns = now;
    const bool is_wanted = policy_ == Follow::kAll || now - one.wanted_ns < kUnusedNs;
    if (has_failed ? now - one.failed_ns >= kFollowRetryNs : !is_wanted) ids.push_back(id);
  }
  return ids;
}

void Followers::note_viewers() {
  std::vector<std::string> ids;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [id, one] : followed_) ids.push_back(id);
  }
  for (const std::string& id : ids) {
    const auto session = registry_.find_followed(id);
    if (!session) continue;
    const FollowNote note{node_, session->figures().participants};
    nats_.send(follow_subject(id), encode_follow(note));
  }
}

void Followers::run(const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  while (!stop.stop_requested()) {
    for (const std::string& id : unused()) {
      std::unique_ptr<CopyFollower> follower;
      {
        const std::lock_guard guard(mutex_);
        const auto found = followed_.find(id);
        if (found == followed_.end()) continue;
        follower = std::move(found->second.follower);
        followed_.erase(found);
      }
      end(id, std::move(follower), "nobody looks at the session here");
    }
    note_viewers();
    wake.wait_for(lock, stop, kNote, [] { return false; });
  }
}

}  // namespace kerf
