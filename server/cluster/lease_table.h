// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/cluster/lease.h"
#include "server/session/session_places.h"

namespace kerf {

/// For so long pages of a server that is gone may use the others, ns: a day.
inline constexpr std::int64_t kPageLifeNs = 86'400'000'000'000;

/// A lease as it was seen last.
struct SeenLease {
  Lease lease;
  std::uint64_t revision = 0;
  std::int64_t since_ns = 0;  ///< when this revision was seen first, by the clock of who sees it
};

/// Another server, and how many sessions it has.
struct OtherServer {
  std::string name, address;
  std::size_t sessions = 0;
  bool only_follows = false;
};

/// What one server has seen of the leases and of the other servers. Has no clock: times are ns of
/// Clock::boot_ns(). It does not know which leases this server holds. Not thread-safe.
class LeaseTable {
 public:
  /// `node` and `run` are this server's.
  LeaseTable(std::string node, std::string run) : node_(std::move(node)), run_(std::move(run)) {}

  /// The revision that is known changes nothing. A smaller one is that of a NATS that has lost
  /// some.
  void note(const std::string& session, Lease lease, std::uint64_t revision, std::int64_t now_ns);
  /// NATS has another state of a lease than the one that is known, as it has after it was restored
  /// from an earlier store. The lease counts as renewed now, since its owner may have renewed it
  /// until NATS was lost. The epoch stays the largest that was seen.
  void correct(const std::string& session, const StoredLease& stored, std::int64_t now_ns);
  void note(const std::string& node, NodeNote note, std::int64_t now_ns);
  /// Nothing could be seen before `now_ns`: no lease counts as older.
  void begin(std::int64_t now_ns) { began_ns_ = now_ns; }

  const SeenLease* find(const std::string& session) const;
  /// The leases that may be taken now: those that have not changed for kLeaseTaken, and released
  /// ones. Those that name another server are left to it for a while.
  std::vector<std::string> takeable(std::int64_t now_ns) const;
  /// Whether a session that this server does not run goes on somewhere, and nobody runs it now.
  bool is_moving(const std::string& session, std::int64_t now_ns) const;
  /// The address of the other server that runs a session now.
  std::optional<std::string> address_of(const std::string& session, std::int64_t now_ns) const;
  /// The sessions that other servers run, or ran last.
  std::vector<PlacedSession> elsewhere() const;
  /// The other servers that have stated themselves lately.
  std::vector<OtherServer> others(std::int64_t now_ns) const;
  /// The addresses at which other servers have stated themselves within kPageLifeNs.
  std::vector<std::string> page_servers(std::int64_t now_ns) const;
  /// The one of the others with the fewest sessions, of those that run some; nullopt: there is
  /// none.
  std::optional<OtherServer> least_loaded(std::int64_t now_ns) const;
  /// A server is thought to get one session more, until it has it or has stated itself twice.
  void expect_session(const std::string& node);

 private:
  struct SeenNode {
    NodeNote note;
    std::int64_t since_ns = 0;
    /// Sessions that it is thought to get, and those of them that it has not got since its last
    /// note.
    std::size_t expected = 0, overdue = 0;
  };
  void note_new(const Lease& lease);
  bool is_own(const SeenLease& seen) const { return seen.lease.run == run_; }
  bool is_fresh(const SeenLease& seen, std::int64_t now_ns) const;

  std::string node_, run_;
  std::int64_t began_ns_ = 0;
  std::map<std::string, SeenLease> leases_;
  std::map<std::string, SeenNode> nodes_;
  std::map<std::string, std::int64_t> pages_;  ///< when each other address was stated last
};

}  // namespace kerf
