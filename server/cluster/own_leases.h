// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <expected>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "server/cluster/lease.h"
#include "server/cluster/nats_connection.h"
#include "server/store/write_fence.h"

namespace kerf {

/// The reason why a lease could not be taken or renewed.
struct LeaseError {
  bool is_lost = false;  ///< another server has it; otherwise NATS is away
  std::string reason;    ///< one sentence
  /// For take(): the revision that NATS has instead of the expected one, if it could be read. A
  /// NATS that has lost its last seconds has an earlier one.
  std::optional<StoredLease> stored = {};
};

/// The leases that this server holds. Each change at NATS states the revision that it replaces, so
/// only one of two servers that try at the same time succeeds. Thread-safe.
class OwnLeases {
 public:
  OwnLeases(NatsConnection& nats, std::string run) : nats_(nats), run_(std::move(run)) {}

  /// Takes the lease whose newest revision is `revision` (0: it does not exist).
  std::expected<void, LeaseError> take(const std::string& session, Lease lease,
                                       std::uint64_t revision);
  /// Stores the lease again and, if it is still held, extends its fence. A lost lease is dropped,
  /// and its fence is closed. `shown`, if given, replaces the fields that lists show.
  std::expected<void, LeaseError> renew(const std::string& session,
                                        const std::optional<ShownSession>& shown);
  /// Stores that the session has ended, then drops the lease. After an error the lease is still
  /// held, and renewals go on. They succeed even if NATS has stored the end.
  std::expected<void, LeaseError> close(const std::string& session);
  /// Stores the lease in another state and drops it in any case.
  void give_back(const std::string& session, LeaseState state, const std::string& to);
  /// Drops a lease that another server has taken.
  void lose(const std::string& session);
  /// Sets the server that should take the sessions, for the next renewals.
  void name_successor(const std::string& node);

  std::shared_ptr<const WriteFence> fence(const std::string& session) const;
  std::optional<Lease> find(const std::string& session) const;
  std::vector<std::string> sessions() const;
  /// Returns the leases to renew.
  std::vector<std::string> due(std::int64_t now_ns) const;

 private:
  struct Held {
    Lease lease;
    std::uint64_t revision = 0;
    std::int64_t sent_ns = 0;
    std::shared_ptr<WriteFence> fence;
  };
  /// The content of the next message about a held lease, and the revision that it replaces.
  struct OwnLease {
    Lease lease;
    std::uint64_t revision = 0;
  };
  NatsResult<std::uint64_t> store(const std::string& session, const Lease& lease,
                                  std::uint64_t revision, int attempts);
  LeaseError read_newest(const std::string& session, std::uint64_t revision);
  std::expected<std::uint64_t, LeaseError> store_own(const std::string& session, const Lease& lease,
                                                     std::uint64_t revision);
  /// Returns a copy of the lease with the present successor; nullopt if the lease is not held.
  std::optional<OwnLease> own_lease(const std::string& session) const;

  NatsConnection& nats_;
  std::string run_;
  std::atomic<std::uint64_t> messages_ = 0;
  mutable std::mutex mutex_;
  std::map<std::string, Held> held_;
  std::string successor_;
};

}  // namespace kerf
