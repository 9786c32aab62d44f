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

/// The stream of the leases, and of what servers state of themselves: the newest message of each
/// subject.
inline constexpr const char* kClusterStream = "KERF_CLUSTER";
inline constexpr const char* kClusterSubjects = "kerf.cluster.*.*";

/// How long a lease lasts. The owner renews it after renew_ns() and changes nothing from
/// `writes_ns` on after it has sent the last renewal that was stored. Others take the lease when it
/// has not changed for taken_ns() after they have seen it: later, also by a clock that runs 20 %
/// faster.
struct LeaseTime {
  std::int64_t writes_ns = 2'500'000'000;
  constexpr std::int64_t renew_ns() const { return writes_ns / 5 * 2; }
  constexpr std::int64_t taken_ns() const { return writes_ns / 25 * 31; }
};
static_assert(LeaseTime{}.taken_ns() * 5 > LeaseTime{}.writes_ns * 6);
inline constexpr std::int64_t kLeaseMsMin = 500, kLeaseMsMax = 60'000;

enum class LeaseState : std::uint8_t {
  kHeld,
  kReleased,  ///< the owner has stopped, and everything is copied: anybody may take it
  kClosed     ///< the session has ended
};

/// What the owner of a session states of it: its epoch, and what lists of sessions show.
struct ShownSession {
  std::uint32_t epoch = 0;  ///< of its journal; at least that of the lease
  std::string name;
  std::uint64_t motions = 0;
  double removed_mm3 = 0;
  std::size_t participants = 0;
  std::int64_t created_ms = 0, active_ms = 0;
};

/// Who runs a session.
struct Lease {
  LeaseState state = LeaseState::kHeld;
  std::string node;         ///< name of the server
  std::string run;          ///< random, of one run of it
  std::string address;      ///< "http://HOST:PORT"
  std::uint32_t epoch = 0;  ///< in which it may change the session
  LeaseTime time = {};      ///< as its owner keeps it: servers may have different ones
  /// The server that is asked to take it: of an owner that is about to stop. Empty: any.
  std::string to;
  ShownSession shown;  ///< its epoch is not part of the message
};

/// The newest state of a lease at NATS.
struct StoredLease {
  std::uint64_t revision = 0;  ///< 0: there is none
  std::optional<Lease> lease;
};

/// A server, as it states every second.
struct NodeNote {
  std::string run;
  std::string address;        ///< empty: it stops
  bool only_follows = false;  ///< it runs no sessions
};

std::vector<std::byte> encode_lease(const Lease& lease);
std::optional<Lease> decode_lease(std::span<const std::byte> bytes);
std::vector<std::byte> encode_node(const NodeNote& note);
std::optional<NodeNote> decode_node(std::span<const std::byte> bytes);

/// The subjects of a session's lease and of a server; the names of such subjects, nullopt for
/// others.
std::string lease_subject(const std::string& session);
std::string node_subject(const std::string& node);
std::optional<std::string> session_of_subject(std::string_view subject);
std::optional<std::string> node_of_subject(std::string_view subject);

}  // namespace kerf
