// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kerf {

/// The stream of the leases and of the servers' announcements. Keeps the newest message of each
/// subject.
inline constexpr const char* kClusterStream = "KERF_CLUSTER";
inline constexpr const char* kClusterSubjects = "kerf.cluster.*.*";

/// Duration of a lease. The owner renews it every renew_ns() and makes no change from `writes_ns`
/// after it sent the last stored renewal. Another server takes the lease when it has not changed
/// for taken_ns() since that server saw it. That is later, even by a clock that runs 20 % faster.
///
/// Proof that there is never a second owner: let A's last stored revision r be sent at s, and let B
/// take the lease expecting r. B saw r at v >= s, and its message is stored at t >= v + taken_ns()
/// by B's clock. If A had renewed after r, B's message would fail. So A accepts nothing from s +
/// writes_ns on, by A's clock, and no renewal of A is stored from t on.
struct LeaseTime {
  std::int64_t writes_ns = 2'500'000'000;
  constexpr std::int64_t renew_ns() const { return writes_ns / 5 * 2; }
  constexpr std::int64_t taken_ns() const { return writes_ns / 25 * 31; }
};
static_assert(LeaseTime{}.taken_ns() * 5 > LeaseTime{}.writes_ns * 6);
inline constexpr std::int64_t kLeaseMsMin = 500, kLeaseMsMax = 60'000;

enum class LeaseState : std::uint8_t {
  kHeld,
  kReleased,  ///< the owner has stopped and everything is copied: any server may take it
  kClosed     ///< the session has ended
};

/// State of a session as published by its owner: its epoch, and the fields that lists show.
struct ShownSession {
  std::uint32_t epoch = 0;  ///< of its journal; at least that of the lease
  std::string name;
  std::uint64_t motions = 0;
  double removed_mm3 = 0;
  std::size_t participants = 0;
  std::int64_t created_ms = 0, active_ms = 0;
};

/// The owner of a session.
struct Lease {
  LeaseState state = LeaseState::kHeld;
  std::string node;         ///< name of the server
  std::string run;          ///< random, of one run of it
  std::string address;      ///< "http://HOST:PORT"
  std::uint32_t epoch = 0;  ///< epoch in which it may change the session
  LeaseTime time = {};      ///< as kept by its owner; servers may differ
  /// The server that should take it, set by an owner that is about to stop. Empty: any.
  std::string to;
  ShownSession shown;  ///< its epoch is not part of the message
};

/// The newest state of a lease at NATS.
struct StoredLease {
  std::uint64_t revision = 0;  ///< 0 if it does not exist
  std::optional<Lease> lease;
};

/// A server's announcement, every second.
struct NodeNote {
  std::string run;
  std::string address;        ///< empty: it stops
  bool only_follows = false;  ///< it runs no sessions
};

std::vector<std::byte> encode_lease(const Lease& lease);
std::optional<Lease> decode_lease(std::span<const std::byte> bytes);
std::vector<std::byte> encode_node(const NodeNote& note);
std::optional<NodeNote> decode_node(std::span<const std::byte> bytes);

/// The subjects of a session's lease and of a server, and the names in such subjects, or nullopt
/// for any other subject.
std::string lease_subject(const std::string& session);
std::string node_subject(const std::string& node);
std::optional<std::string> session_of_subject(std::string_view subject);
std::optional<std::string> node_of_subject(std::string_view subject);

}  // namespace kerf
