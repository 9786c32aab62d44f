// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/lease_table.h"

#include <algorithm>

namespace kerf {
namespace {

/// Time for which a released lease is reserved for the server that it names.
constexpr std::int64_t kNamedFirstNs = 1'500'000'000;
/// A server without an announcement for this long is not counted.
constexpr std::int64_t kNodeNs = 5'000'000'000;

}  // namespace

void LeaseTable::note(const std::string& session, Lease lease, std::uint64_t revision,
                      std::int64_t now_ns) {
  SeenLease& seen = leases_[session];
  if (revision == seen.revision) return;
  const bool is_new = seen.revision == 0 || seen.lease.state == LeaseState::kClosed;
  if (is_new) note_new(lease);
  seen = {std::move(lease), revision, now_ns};
}

void LeaseTable::correct(const std::string& session, const StoredLease& stored,
                         std::int64_t now_ns) {
  if (!leases_.contains(session) && !stored.lease) return;
  SeenLease& seen = leases_[session];
  const std::uint32_t epoch = seen.lease.epoch;
  if (stored.lease) seen.lease = *stored.lease;
  seen.lease.epoch = std::max(seen.lease.epoch, epoch);
  seen.revision = stored.revision;
  seen.since_ns = now_ns;
  seen.needs_owner = false;
}

void LeaseTable::note_uncopied(const std::string& session, std::uint64_t revision) {
  const auto found = leases_.find(session);
  if (found != leases_.end() && found->second.revision == revision) {
    found->second.needs_owner = true;
  }
}

/// A session expected of a server has been created there.
void LeaseTable::note_new(const Lease& lease) {
  const auto node = nodes_.find(lease.node);
  if (node == nodes_.end()) return;
  SeenNode& seen = node->second;
  if (seen.expected > 0) --seen.expected;
  seen.overdue = std::min(seen.overdue, seen.expected);
}

void LeaseTable::note(const std::string& node, NodeNote note, std::int64_t now_ns) {
  if (note.run != run_ && !note.address.empty()) pages_[note.address] = now_ns;
  std::erase_if(pages_, [&](const auto& page) { return now_ns - page.second >= kPageLifeNs; });
  SeenNode& seen = nodes_[node];
  seen.note = std::move(note);
  seen.since_ns = now_ns;
  seen.expected -= seen.overdue;  // a client that was redirected there did not go
  seen.overdue = seen.expected;
}

const SeenLease* LeaseTable::find(const std::string& session) const {
  const auto found = leases_.find(session);
  return found == leases_.end() ? nullptr : &found->second;
}

bool LeaseTable::is_fresh(const SeenLease& seen, std::int64_t now_ns) const {
  return now_ns - std::max(seen.since_ns, began_ns_) < seen.lease.time.taken_ns();
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
  if (seen->needs_owner) return false;
  return seen->lease.state == LeaseState::kReleased || is_own(*seen) || !seen->lease.to.empty() ||
         !is_fresh(*seen, now_ns);
}

std::optional<std::string> LeaseTable::address_of(const std::string& session,
                                                  std::int64_t now_ns) const {
  const SeenLease* seen = find(session);
  const bool runs = seen != nullptr && seen->lease.state == LeaseState::kHeld && !seen->needs_owner;
  if (!runs || is_moving(session, now_ns)) return std::nullopt;
  return seen->lease.address;
}

std::optional<std::string> LeaseTable::needed_server(const std::string& session) const {
  const SeenLease* seen = find(session);
  return seen != nullptr && seen->needs_owner ? std::optional(seen->lease.node) : std::nullopt;
}

std::vector<PlacedSession> LeaseTable::elsewhere() const {
  std::vector<PlacedSession> list;
  for (const auto& [id, seen] : leases_) {
    const Lease& lease = seen.lease;
    if (lease.state == LeaseState::kClosed || is_own(seen)) continue;
    const ShownSession& shown = lease.shown;
    list.push_back({id, shown.name, lease.node, lease.address, shown.motions, shown.removed_mm3,
                    shown.participants, shown.created_ms, shown.active_ms});
  }
  return list;
}

std::vector<OtherServer> LeaseTable::others(std::int64_t now_ns) const {
  std::vector<OtherServer> list;
  for (const auto& [name, node] : nodes_) {
    const std::string& run = node.note.run;
    const bool counts =
        run != run_ && !node.note.address.empty() && now_ns - node.since_ns < kNodeNs;
    if (!counts) continue;
    const auto sessions = std::ranges::count_if(leases_, [&](const auto& entry) {
      const Lease& lease = entry.second.lease;
      return lease.run == run && lease.state == LeaseState::kHeld;
    });
    list.push_back({name, node.note.address, static_cast<std::size_t>(sessions) + node.expected,
                    node.note.only_follows});
  }
  return list;
}

std::vector<std::string> LeaseTable::page_servers(std::int64_t now_ns) const {
  std::vector<std::string> addresses;
  for (const auto& [address, since_ns] : pages_) {
    if (now_ns - since_ns < kPageLifeNs) addresses.push_back(address);
  }
  return addresses;
}

std::optional<OtherServer> LeaseTable::least_loaded(std::int64_t now_ns) const {
  auto list = others(now_ns);
  std::erase_if(list, [](const OtherServer& server) { return server.only_follows; });
  const auto least = std::ranges::min_element(list, {}, &OtherServer::sessions);
  return least == list.end() ? std::nullopt : std::optional(std::move(*least));
}

void LeaseTable::expect_session(const std::string& node) {
  const auto known = nodes_.find(node);
  if (known != nodes_.end()) ++known->second.expected;
}

}  // namespace kerf
