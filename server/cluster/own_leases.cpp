// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/own_leases.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "server/platform/clock.h"

namespace kerf {
namespace {

/// Time for the answer to a renewal: about half of the time until its fence closes.
std::chrono::milliseconds answer_time(const LeaseTime& time) {
  const std::chrono::nanoseconds left(time.writes_ns - time.renew_ns());
  return std::chrono::duration_cast<std::chrono::milliseconds>(left / 2);
}
constexpr int kAttempts = 3;

}  // namespace

NatsResult<std::uint64_t> OwnLeases::store(const std::string& session, const Lease& lease,
                                           std::uint64_t revision, int attempts) {
  const std::string id = "lease/" + session + "/" + run_ + "/" + std::to_string(++messages_);
  const std::vector<std::byte> bytes = encode_lease(lease);
  for (int n = 1;; ++n) {
    auto stored =
        nats_.publish(lease_subject(session), bytes, id, revision, answer_time(lease.time));
    // A late answer leaves open whether the message was stored. NATS recognizes it by its id.
    const bool is_answered = stored || stored.error().code == NatsErrorCode::kNotNext;
    if (is_answered || n == attempts || !nats_.is_connected()) return stored;
  }
}

/// After a stale revision, reads the newest one.
LeaseError OwnLeases::read_newest(const std::string& session, std::uint64_t revision) {
  LeaseError error{.is_lost = true, .reason = "another server has taken the lease"};
  const auto last = nats_.last_message(kClusterStream, lease_subject(session));
  if (!last) return error;
  error.stored.emplace();
  if (*last) error.stored = {(*last)->sequence, decode_lease((*last)->bytes)};
  if (error.stored->revision < revision) {
    error.reason = "NATS has lost messages: revision " + std::to_string(revision) +
                   " of its lease was seen, the newest one now is " +
                   std::to_string(error.stored->revision);
  }
  return error;
}

std::expected<void, LeaseError> OwnLeases::take(const std::string& session, Lease lease,
                                                std::uint64_t revision) {
  const std::int64_t sent = Clock::boot_ns();
  const auto stored = store(session, lease, revision, kAttempts);
  if (!stored && stored.error().code == NatsErrorCode::kNotNext) {
    return std::unexpected(read_newest(session, revision));
  }
  if (!stored) return std::unexpected(LeaseError{false, stored.error().reason});
  auto fence = std::make_shared<WriteFence>();
  fence->extend(sent + lease.time.writes_ns);
  const std::lock_guard lock(mutex_);
  held_[session] = {std::move(lease), *stored, sent, std::move(fence)};
  return {};
}

/// Stores a lease of this run again. A lost acknowledgement does not make it foreign.
std::expected<std::uint64_t, LeaseError> OwnLeases::store_own(const std::string& session,
                                                              const Lease& lease,
                                                              std::uint64_t revision) {
  for (int n = 0; n < kAttempts; ++n) {
    const auto stored = store(session, lease, revision, 1);
    if (stored) return *stored;
    if (stored.error().code != NatsErrorCode::kNotNext) {
      return std::unexpected(LeaseError{false, stored.error().reason});
    }
    const auto last = nats_.last_message(kClusterStream, lease_subject(session));
    if (!last) return std::unexpected(LeaseError{false, last.error().reason});
    // NATS has lost the lease. Its last state counts, as for every other server.
    if (!*last) {
      revision = 0;
      continue;
    }
    const auto seen = decode_lease((*last)->bytes);
    // The lease of a run that holds it is closed there if the answer to close() was lost.
    if (!seen || seen->run != run_ || seen->state == LeaseState::kReleased) {
      return std::unexpected(LeaseError{true, "another server has taken the lease"});
    }
    revision = (*last)->sequence;
  }
  return std::unexpected(LeaseError{false, "the lease changes all the time"});
}

std::optional<OwnLeases::OwnLease> OwnLeases::own_lease(const std::string& session) const {
  const std::lock_guard lock(mutex_);
  const auto held = held_.find(session);
  if (held == held_.end()) return std::nullopt;
  OwnLease own{held->second.lease, held->second.revision};
  own.lease.to = successor_;
  return own;
}

std::expected<void, LeaseError> OwnLeases::renew(const std::string& session,
                                                 const std::optional<ShownSession>& shown) {
  auto own = own_lease(session);
  if (!own) return {};
  auto& [lease, revision] = *own;
  if (shown) {
    lease.shown = *shown;
    lease.epoch = std::max(lease.epoch, shown->epoch);
  }
  const std::int64_t sent = Clock::boot_ns();
  const auto stored = store_own(session, lease, revision);
  if (!stored && stored.error().is_lost) lose(session);
  if (!stored) return std::unexpected(stored.error());
  const std::lock_guard lock(mutex_);
  const auto held = held_.find(session);
  if (held == held_.end()) return {};
  held->second.fence->extend(sent + lease.time.writes_ns);
  held->second.lease = std::move(lease);
  held->second.revision = *stored;
  held->second.sent_ns = sent;
  return {};
}

std::expected<void, LeaseError> OwnLeases::close(const std::string& session) {
  auto own = own_lease(session);
  if (!own) return std::unexpected(LeaseError{true, "another server has taken the lease"});
  auto& [lease, revision] = *own;
  lease.state = LeaseState::kClosed;
  lease.to.clear();
  if (const auto ok = store_own(session, lease, revision); !ok) return std::unexpected(ok.error());
  lose(session);
  return {};
}

void OwnLeases::give_back(const std::string& session, LeaseState state, const std::string& to) {
  Held held;
  {
    const std::lock_guard lock(mutex_);
    const auto found = held_.find(session);
    if (found == held_.end()) return;
    held = std::move(found->second);
    held_.erase(found);
  }
  held.fence->end();
  held.lease.state = state;
  held.lease.to = to;
  (void)store_own(session, held.lease, held.revision);  // otherwise it expires
}

void OwnLeases::lose(const std::string& session) {
  const std::lock_guard lock(mutex_);
  const auto found = held_.find(session);
  if (found == held_.end()) return;
  found->second.fence->end();
  held_.erase(found);
}

void OwnLeases::name_successor(const std::string& node) {
  const std::lock_guard lock(mutex_);
  successor_ = node;
}

std::shared_ptr<const WriteFence> OwnLeases::fence(const std::string& session) const {
  const std::lock_guard lock(mutex_);
  const auto found = held_.find(session);
  // A lease lost in the meantime leaves a closed fence.
  return found == held_.end() ? std::make_shared<WriteFence>() : found->second.fence;
}

std::optional<Lease> OwnLeases::find(const std::string& session) const {
  const std::lock_guard lock(mutex_);
  const auto found = held_.find(session);
  return found == held_.end() ? std::nullopt : std::optional(found->second.lease);
}

std::vector<std::string> OwnLeases::sessions() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> ids;
  for (const auto& [id, held] : held_) ids.push_back(id);
  return ids;
}

std::vector<std::string> OwnLeases::due(std::int64_t now_ns) const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> ids;
  for (const auto& [id, held] : held_) {
    if (now_ns - held.sent_ns >= held.lease.time.renew_ns()) ids.push_back(id);
  }
  return ids;
}

}  // namespace kerf
