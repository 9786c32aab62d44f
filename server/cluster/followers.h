// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "server/cluster/copy_follower.h"
#include "server/cluster/nats_connection.h"
#include "server/session/session_registry.h"

namespace kerf {

/// The sessions of other servers that a server follows.
enum class Follow : std::uint8_t {
  kNone,
  kViewed,  ///< those with viewers here, until a while after the last one has left
  kAll,     ///< all, so that it can take over each at once
  kOnly     ///< as kViewed, and it runs no sessions
};
/// Parses "none", "viewed", "all" or "only".
std::optional<Follow> parse_follow(std::string_view name);

/// A server that follows a session, as announced every second to the owner.
struct FollowNote {
  std::string node;
  std::size_t viewers = 0;
};
std::vector<std::byte> encode_follow(const FollowNote& note);
std::optional<FollowNote> decode_follow(std::span<const std::byte> bytes);
/// The subject of these notes, and the session of one, or nullopt for other subjects.
std::string follow_subject(const std::string& session);
std::optional<std::string> followed_by_subject(std::string_view subject);

/// The sessions of other servers that this server follows. Thread-safe.
class Followers {
 public:
  /// `node` is this server. All must outlive it.
  Followers(NatsConnection& nats, SessionRegistry& registry, std::string node, Follow policy);
  /// Ends all, and their sessions.
  ~Followers();
  Followers(const Followers&) = delete;
  Followers& operator=(const Followers&) = delete;

  /// Requests a session that another server runs. Returns whether it is followed, or will be soon.
  bool want(const std::string& session);
  bool is_following(const std::string& session) const;
  /// Sets the sessions of other servers, and those that this one is about to take, as known at
  /// `known_ns` (Clock::boot_ns()). Following ends for all other sessions, unless they were
  /// requested later.
  void set_elsewhere(const std::vector<std::string>& sessions,
                     const std::vector<std::string>& taken, std::int64_t known_ns);
  /// This server is about to run the session: its journal gets the rest of the copy and a snapshot,
  /// and its viewers reconnect. Returns whether the journal has all of the copy; false if the
  /// session is not followed.
  bool finish(const std::string& session);
  /// Ends all following for good.
  void stop();

 private:
  struct Followed {
    std::unique_ptr<CopyFollower> follower;  ///< null after a failure
    std::int64_t begun_ns = 0;
    std::int64_t wanted_ns = 0;  ///< when it was last requested
    std::int64_t failed_ns = 0;
  };
  void run(const std::stop_token& stop);
  void note_viewers();
  std::vector<std::string> unused();
  void end(const std::string& session, std::unique_ptr<CopyFollower> follower,
           const std::string& reason);

  NatsConnection& nats_;
  SessionRegistry& registry_;
  const std::string node_;
  const Follow policy_;
  mutable std::mutex mutex_;
  bool has_stopped_ = false;
  std::map<std::string, Followed> followed_;
  std::jthread thread_;
};

}  // namespace kerf
