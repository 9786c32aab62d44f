// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/lease_table.h"

#include <algorithm>

namespace kerf {
namespace {

/// Time for which a released lease is left to the server that it names.
constexpr std::int64_t kNamedFirstNs = 1'500'000'000;
/// A server that has not stated itself for this long is not counted.
constexpr std::int64_t kNodeNs = 5'000'000'000;

}  // namespace

void LeaseTable::note(const std::string& session, Lease lease, std::uint64_t revision,
                      std::int64_t now_ns) {
  SeenLease& seen = leases_[session];
  if (revision == seen.revision) return;
  seen = {std::move(lease), revision, now_ns};
}

void LeaseTable::note(const std::string& node, NodeNote note, std::int64_t now_ns) {
  nodes_[node] = {std::move(note), now_ns};
}

const SeenLease* LeaseTable::find(const std::string& session) const {
  const auto found = leases_.find(session);
  return found == leases_.end() ? nullptr : &found->second;
}

bool LeaseTable::is_fresh(const SeenLease& seen, std::int64_t now_ns) const {
  return now_ns - std::max(seen.since_ns, began_ns_) < kLeaseTakenNs;
}

std::vector<std::string> LeaseTable::takeable(std::int64_t now_ns) const {
  std::vector<std::string> ids;
  for (const auto& [id, seen] : leases_) {
    const Lease& lease = seen.lease;
    if (lease.state == LeaseState::kClosed) continue;
    const bool is_named = lease.to.empty() || lease.to == node_;
    const bool is_released = lease.state == LeaseState::kReleased &&
                             (is_named || now_ns - seen.since_ns >= kNamedFirstNs);
    if (is_released || !is_fresh(seen, now_ns)) ids.push_back(id);
  }
  return ids;
}

bool LeaseTable::is_moving(const std::string& session, std::int64_t now_ns) const {
  const SeenLease* seen = find(session);
  if (seen == nullptr || seen->lease.state == LeaseState::kClosed) return false;
  return seen->lease.state == LeaseState::kReleased || is_own(*seen) || !seen->lease.to.empty() ||
         !is_fresh(*seen, now_ns);
}

std::optional<std::string> LeaseTable::address_of(const std::string& session,
                                                  std::int64_t now_ns) const {
  const SeenLease* seen = find(session);
  const bool runs = seen != nullptr && seen->lease.state == LeaseState::kHeld;
  if (!runs || is_moving(session, now_ns)) return std::nullopt;
  return seen->lease.address;
}

std::vector<PlacedSession> LeaseTable::elsewhere() const {
  std::vector<PlacedSession> list;
  for (const auto& [id, seen] : leases_) {
    const Lease& lease = seen.lease;
    if (lease.state == LeaseState::kClosed || is_own(seen)) continue;
    list.push_back({id, lease.name, lease.node, lease.address, lease.motions, lease.removed_mm3,
                    lease.participants, lease.created_ms, lease.active_ms});
  }
  return list;
}

std::vector<std::pair<std::string, NodeNote>> LeaseTable::others(std::int64_t now_ns) const {
  std::vector<std::pair<std::string, NodeNote>> list;
  for (const auto& [name, node] : nodes_) {
    const bool counts =
        node.note.run != run_ && !node.note.address.empty() && now_ns - node.since_ns < kNodeNs;
    if (counts) list.emplace_back(name, node.note);
  }
  return list;
}

}  // namespace kerf
