// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "server/cluster/copies.h"
#include "server/cluster/nats_connection.h"
#include "server/session/session_registry.h"

namespace kerf {

/// Follows a session that another server runs, on its own thread: fetches the copy of its journal,
/// restores the block, and applies every later change of the copy. The registry has the session in
/// the meantime (find_followed()).
class CopyFollower {
 public:
  enum class State : std::uint8_t { kBegins, kFollows, kFailed };

  /// `node` is the name of this server. All must outlive it.
  CopyFollower(NatsConnection& nats, SessionRegistry& registry, std::string session,
               std::string node);
  ~CopyFollower();
  CopyFollower(const CopyFollower&) = delete;
  CopyFollower& operator=(const CopyFollower&) = delete;

  State state() const { return state_; }
  /// Applies the rest of the copy, waiting for at most `wait`, and ends. Returns whether the
  /// journal then has all of it. The session stays in the registry.
  bool finish(std::chrono::milliseconds wait);

 private:
  struct Followed;
  void run(const std::stop_token& stop);
  std::expected<void, std::string> follow(const std::stop_token& stop);
  std::expected<void, std::string> take_messages(Followed& followed, const std::stop_token& stop);
  std::expected<void, std::string> look_back(Followed& followed);
  std::expected<void, std::string> take(Followed& followed, const StreamMessage& message);
  std::expected<void, std::string> deliver(Followed& followed);
  std::expected<void, std::string> deliver_lists(Followed& followed);
  std::expected<void, std::string> compare(Followed& followed);
  NatsListener hear_live(const std::shared_ptr<Session>& session) const;

  NatsConnection& nats_;
  SessionRegistry& registry_;
  std::string id_, node_;
  std::atomic<State> state_ = State::kBegins;
  std::atomic<std::uint64_t> message_ = 0;  ///< the last one received
  std::jthread thread_;
};

/// The subject on which the owner of a session publishes its LiveState.
std::string live_subject(const std::string& session);

}  // namespace kerf
