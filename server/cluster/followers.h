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

/// Which sessions of other servers a server follows.
enum class Follow : std::uint8_t {
  kNone,
  kViewed,  ///< those for which viewers come here, until a while after the last one has left
  kAll,     ///< all, so that it can go on with each at once
  kOnly     ///< as kViewed, and it runs none itself
};
/// Returns the policy that "none", "viewed", "all" or "only" names.
std::optional<Follow> parse_follow(std::string_view name);

/// A server that follows a session, as it states every second to the owner.
struct FollowNote {
  std::string node;
  std::size_t viewers = 0;
};
std::vector<std::byte> encode_follow(const FollowNote& note);
std::optional<FollowNote> decode_follow(std::span<const std::byte> bytes);
/// The subject of these notes, and the session of one; nullopt for other subjects.
std::string follow_subject(const std::string& session);
std::optional<std::string> followed_by_subject(std::string_view subject);

/// The sessions of other servers that this server follows. Thread-safe.
class Followers {
 public:
  /// `node` is this server. All must outlive it.
  Followers(NatsConnection& nats, SessionRegistry& registry, std::string node, Follow policy);
  /// Ends all: their sessions too.
  ~Followers();
  Followers(const Followers&) = delete;
  Followers& operator=(const Followers&) = delete;

  /// Somebody wants to look at a session, which another server runs. Whether it is followed, or
  /// will be soon.
  bool want(const std::string& session);
  bool is_following(const std::string& session) const;
  /// The sessions that other servers have, and those that this one is about to take, as they were
  /// known at the time `known_ns` (Clock::boot_ns): others are followed no more, unless they are
  /// wanted since then only.
  void set_elsewhere(const std::vector<std::string>& sessions,
                     const std::vector<std::string>& taken, std::int64_t known_ns);
  /// This server is about to run the session: its journal gets what the copy has, and a snapshot,
  /// and its viewers come again. Whether the journal has all of the copy; false if the session is
  /// not followed.
  bool finish(const std::string& session);
  /// Follows nothing more, from now on.
  void stop();

 private:
  struct Followed {
    std::unique_ptr<CopyFollower> follower;  ///< null: it has failed
    std::int64_t begun_ns = 0;
    std::int64_t wanted_ns = 0;  ///< when somebody wanted it last
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
