// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/live_states.h"

#include <algorithm>
#include <condition_variable>
#include <utility>

#include "server/cluster/copy_follower.h"
#include "server/cluster/followers.h"
#include "server/session/live_state.h"
#include "server/store/write_fence.h"
#include "server/threads/run_and_wait.h"

namespace kerf {
namespace {

constexpr std::chrono::milliseconds kInterval{40};
/// A follower without an announcement for so long is gone. It announces itself every second.
constexpr std::int64_t kFollowerSilenceNs = 3'000'000'000;

}  // namespace

LiveStates::LiveStates(NatsConnection& nats, SessionRegistry& registry, std::string node)
    : nats_(nats),
      registry_(registry),
      node_(std::move(node)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

LiveStates::~LiveStates() { thread_ = {}; }

void LiveStates::hear() {
  auto listener = nats_.listen(follow_subject("*"), [this](const StreamMessage& message) {
    const auto session = followed_by_subject(message.subject);
    const auto note = decode_follow(message.bytes);
    if (!session || !note || note->node == node_) return;
    const std::lock_guard lock(mutex_);
    followed_[*session][note->node] = {note->viewers, Clock::boot_ns()};
  });
  if (listener) listener_ = *std::move(listener);
}

/// Returns the sessions with their followers. A session that lost its last follower is returned
/// once, so that its viewers are no longer counted.
std::map<std::string, LiveStates::Followers> LiveStates::fresh() {
  const std::int64_t now = Clock::boot_ns();
  const std::lock_guard lock(mutex_);
  for (auto& [session, followers] : followed_) {
    std::erase_if(followers,
                  [&](const auto& one) { return now - one.second.since_ns > kFollowerSilenceNs; });
  }
  auto sessions = followed_;
  std::erase_if(followed_, [](const auto& one) { return one.second.empty(); });
  return sessions;
}

void LiveStates::state(const std::string& session_id, const Followers& followers) {
  const auto session = registry_.find(session_id);
  if (!session) return;
  std::size_t elsewhere = 0;
  for (const auto& [node, follower] : followers) elsewhere += follower.viewers;
  LiveState state = run_and_wait(session->executor(), [&] {
    session->note_viewers_elsewhere(elsewhere);
    return session->live_state();
  });
  if (followers.empty()) return;
  for (const auto& [node, follower] : followers) state.viewers[node] = follower.viewers;
  nats_.send(live_subject(session_id), encode_live(state));
}

void LiveStates::run(const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  while (!stop.stop_requested()) {
    if (!listener_) hear();
    for (const auto& [session, followers] : fresh()) state(session, followers);
    wake.wait_for(lock, stop, kInterval, [] { return false; });
  }
}

}  // namespace kerf
