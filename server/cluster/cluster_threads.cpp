// SPDX-License-Identifier: Apache-2.0
// The threads of a ClusterNode: one renews its leases, one watches all leases, and some take the
// leases of lost servers.
#include <algorithm>
#include <condition_variable>
#include <filesystem>
#include <system_error>

#include "server/cluster/cluster_node_impl.h"
#include "server/cluster/snapshot_copy.h"
#include "server/cluster/takeover.h"
#include "server/log/log.h"
#include "server/platform/clock.h"
#include "server/store/journal_file.h"

namespace kerf {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kTick{100};
/// Longest silence of a working watch: this server's own note comes every second.
constexpr std::int64_t kSilenceNs = 3'000'000'000;
constexpr std::int64_t kNoteNs = 1'000'000'000;
/// A free lease is tried after a random time up to the first constant, plus the second for each
/// session that this server has, so that the sessions of a lost server are spread.
constexpr std::int64_t kSpreadNs = 150'000'000, kPerSessionNs = 30'000'000;
constexpr std::size_t kSessionsCounted = 10;
/// Additional delay, so that a server that follows the session takes it first.
constexpr std::int64_t kFollowersFirstNs = 50'000'000;
/// Time until a session that could not be taken is retried.
constexpr std::int64_t kRetryNs = 5'000'000'000;

/// Waits for a tick. Returns false if the thread has to end.
bool pause(const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  wake.wait_for(lock, stop, kTick, [] { return false; });
  return !stop.stop_requested();
}

void log_failure(const std::string& id, const std::string& reason) {
  log::error("session " + id + " cannot be taken over: " + reason);
}

}  // namespace

/// Returns the fields that lists show of a session of this server.
std::optional<ShownSession> ClusterNode::Impl::shown(const std::string& id) const {
  const auto session = registry->find(id);
  if (!session) return std::nullopt;
  const SessionFigures figures = session->figures();
  return ShownSession{.epoch = session->epoch(),
                      .name = session->scene()->name,
                      .motions = figures.motions,
                      .removed_mm3 = figures.removed_mm3,
                      .participants = figures.participants,
                      .created_ms = figures.created_ms,
                      .active_ms = figures.active_ms};
}

void ClusterNode::Impl::renew(const std::string& id) {
  const auto renewed = own.renew(id, shown(id));
  const std::string fault = renewed ? "" : renewed.error().reason;
  if (!renewed && renewed.error().is_lost) {
    const std::lock_guard lock(mutex);
    lost.try_emplace(id, Clock::boot_ns());
    faults.erase(id);
    return;
  }
  std::string& known = faults[id];
  if (std::exchange(known, fault) == fault) return;
  if (fault.empty()) {
    log::info("session " + id + ": its lease is renewed again");
  } else {
    log::error("session " + id +
               ": its lease cannot be renewed, and it pauses when that takes long: " + fault);
  }
}

/// Announces this server.
void ClusterNode::Impl::state_itself() {
  const std::int64_t now = Clock::boot_ns();
  if (now - noted_ns < kNoteNs) return;
  noted_ns = now;
  NodeNote note{run, address, only_follows};
  {
    const std::lock_guard lock(mutex);
    if (holds) note.address.clear();
  }
  const std::string subject = node_subject(node);
  const auto last = nats.last_message(kClusterStream, subject);
  if (!last) return;
  const std::string id = "node/" + run + "/" + std::to_string(now);
  (void)nats.publish(subject, encode_node(note), id, *last ? (*last)->sequence : 0,
                     milliseconds(500));
}

void ClusterNode::Impl::renew_all(const std::stop_token& stop) {
  do {
    for (const std::string& id : own.due(Clock::boot_ns())) renew(id);
    if (nats.is_connected()) state_itself();
  } while (pause(stop));
}

void ClusterNode::Impl::take_note(const StreamMessage& message) {
  const std::int64_t now = Clock::boot_ns();
  const auto session = session_of_subject(message.subject);
  const auto lease = session ? decode_lease(message.bytes) : std::nullopt;
  const auto other = node_of_subject(message.subject);
  const auto note = other ? decode_node(message.bytes) : std::nullopt;
  const bool is_foreign = lease && lease->run != run && lease->state != LeaseState::kClosed;
  const auto mine = is_foreign ? own.find(*session) : std::nullopt;
  const std::lock_guard lock(mutex);
  heard_ns = now;
  if (note) table.note(*other, *note, now);
  if (!lease) return;
  table.note(*session, *lease, message.sequence, now);
  due_ns.erase(*session);
  // The watch may be behind this server's own newer leases.
  if (mine && lease->epoch > mine->epoch) {
    own.lose(*session);
    lost.try_emplace(*session, now);
  }
}

/// Follows the leases until the watch fails.
void ClusterNode::Impl::watch(const std::stop_token& stop) {
  if (!nats.make_stream(kClusterStream, kClusterSubjects, replicas, Keep::kLastOfSubject)) return;
  auto messages = nats.watch(kClusterStream, kClusterSubjects);
  if (!messages) return;
  {
    const std::lock_guard lock(mutex);
    heard_ns = Clock::boot_ns();
    table.begin(heard_ns);
  }
  while (!stop.stop_requested()) {
    const auto message = messages->next(kTick);
    if (!message) return;
    if (*message) take_note(**message);
    const std::lock_guard lock(mutex);
    if (Clock::boot_ns() - heard_ns > kSilenceNs) return;
  }
}

void ClusterNode::Impl::watch_all(const std::stop_token& stop) {
  do {
    watch(stop);
    const std::lock_guard lock(mutex);
    heard_ns = 0;
  } while (pause(stop));
}

/// Finds the journals of the data folder, whose sessions may have no owner.
void ClusterNode::Impl::find_local() {
  std::error_code ignored;
  const auto folder = registry->closed_folder().parent_path();
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string id = entry.path().stem().string();
    if (entry.path().extension() == kJournalExtension && is_session_id(id)) local.insert(id);
  }
}

std::optional<std::string> ClusterNode::Impl::next_to_take() {
  const std::int64_t now = Clock::boot_ns();
  const std::size_t sessions = std::min(own.sessions().size(), kSessionsCounted);
  const std::lock_guard lock(mutex);
  if (only_follows || holds || heard_ns == 0) return std::nullopt;
  auto free = table.takeable(now);
  for (const std::string& id : local) {
    if (table.find(id) == nullptr) free.push_back(id);
  }
  for (const std::string& id : free) {
    const auto again = again_ns.find(id);
    const bool has_failed = again != again_ns.end() && now < again->second;
    if (taking.contains(id) || ending.contains(id) || has_failed || own.find(id)) continue;
    const bool is_ready = followers && followers->is_following(id);
    const auto spread = is_ready
                            ? 0
                            : kFollowersFirstNs + static_cast<std::int64_t>(chance() % kSpreadNs) +
                                  static_cast<std::int64_t>(sessions) * kPerSessionNs;
    const auto due = due_ns.try_emplace(id, now + spread).first;
    if (now < due->second) continue;
    due->second = now + kRetryNs;
    taking.insert(id);
    return id;
  }
  return std::nullopt;
}

/// Notes the stored lease after a failed take: another server was faster, or NATS has lost messages
/// that this server had seen. The session is then free later than it seemed.
void ClusterNode::Impl::note_not_taken(const std::string& id, const SeenLease& seen,
                                       const LeaseError& error) {
  const bool has_lost = error.stored && error.stored->revision < seen.revision;
  if (has_lost || !error.is_lost) log_failure(id, error.reason + "; it is tried again");
  if (!error.stored) return;
  const std::lock_guard lock(mutex);
  table.correct(id, *error.stored, Clock::boot_ns());
  due_ns.erase(id);
}

/// Takes the lease in the next epoch, which it returns; nullopt if another server is faster.
std::optional<std::uint32_t> ClusterNode::Impl::take_lease(const std::string& id,
                                                           const SeenLease& seen,
                                                           std::uint32_t epoch_of_copy) {
  Lease lease = seen.lease;
  lease.state = LeaseState::kHeld;
  lease.node = node;
  lease.run = run;
  lease.address = address;
  lease.to.clear();
  lease.epoch = std::max(seen.lease.epoch, epoch_of_copy) + 1;
  lease.time = lease_time;
  if (const auto taken = own.take(id, lease, seen.revision); !taken) {
    note_not_taken(id, seen, taken.error());
    return std::nullopt;
  }
  return lease.epoch;
}

/// A session without a copy is only in the journal of the server that had its lease last. No other
/// server takes the lease, so that its owner stays known. If this server had it and has no journal,
/// the session was never started, because the answer to its claim was lost: it is ended.
void ClusterNode::Impl::leave(const std::string& id, const SeenLease& seen) {
  if (seen.lease.node == node) {
    if (registry->is_reserved(id) || !take_lease(id, seen, 0)) return;
    own.give_back(id, LeaseState::kClosed, {});
    return log::warn("session " + id + ": it has ended, because it was never started");
  }
  const std::lock_guard lock(mutex);
  const bool is_new = !again_ns.contains(id);
  again_ns[id] = Clock::boot_ns() + kRetryNs;
  table.note_uncopied(id, seen.revision);
  if (is_new) {
    log::warn("session " + id + ": it is not copied, so only server " + seen.lease.node +
              " can continue it");
  }
}

/// Ends the session that this server has run until it lost the lease which it has taken again: only
/// one session may write a journal.
void ClusterNode::Impl::end_former(const std::string& id) {
  {
    const std::lock_guard lock(mutex);
    lost.erase(id);
  }
  registry->hand_over(id, "this server had lost the session's lease, and continues it now", "");
}

/// Takes a lease and opens its session, unless another server is faster.
void ClusterNode::Impl::take(const std::string& id) {
  SeenLease seen;
  {
    const std::lock_guard lock(mutex);
    if (const SeenLease* known = table.find(id)) seen = *known;
  }
  const auto epoch = epoch_of_copy(nats, id);
  if (!epoch) return log_failure(id, epoch.error());
  std::error_code ignored;
  if (*epoch == 0 && !std::filesystem::exists(registry->journal_path(id), ignored)) {
    return leave(id, seen);
  }
  const auto taken = take_lease(id, seen, *epoch);
  if (!taken) return;
  log::info("session " + id + ": taken over" +
            (seen.lease.node.empty() ? "" : " from " + seen.lease.node) + ", epoch " +
            std::to_string(*taken));
  end_former(id);
  registry->expect(id);
  const bool is_open = open(id);
  registry->give_up(id);
  {
    const std::lock_guard lock(mutex);
    if (is_open && !own.find(id)) lost.try_emplace(id, Clock::boot_ns());  // in the meantime
    if (is_open) return;
    again_ns[id] = Clock::boot_ns() + kRetryNs;
  }
  own.give_back(id, LeaseState::kReleased, {});
}

bool ClusterNode::Impl::open(const std::string& id) {
  const auto lease = own.find(id);
  if (!lease) return false;
  const bool is_current = followers && followers->finish(id);
  const auto prepared = prepare_journal(nats, id, lease->epoch, registry->journal_path(id),
                                        registry->closed_folder(), is_current);
  if (!prepared) {
    log_failure(id, prepared.error());
    return false;
  }
  const auto fetched = fetch_snapshots(nats, id, lease->epoch, registry->journal_path(id));
  if (!fetched) {
    log::warn("session " + id + ": a snapshot of its copy cannot be used: " + fetched.error());
  }
  LoadReport opened;
  registry->open(id, opened);
  report(opened);
  return registry->find(id) != nullptr;
}

void ClusterNode::Impl::hand_over_lost() {
  std::map<std::string, std::string> ended;  // and where they continue
  {
    const std::lock_guard lock(mutex);
    const std::int64_t now = Clock::boot_ns();
    std::erase_if(lost, [&](const auto& session) {
      const auto& [id, since] = session;
      if (taking.contains(id)) return false;  // end_former() ends it,
      if (own.find(id)) return true;          // and has ended this one
      const auto at = table.address_of(id, now);
      if (!at && now - since < kSilenceNs) return false;  // the watch will report it
      ended.emplace(id, at.value_or(""));
      ending.insert(id);
      return true;
    });
  }
  for (const auto& [id, at] : ended) {
    log::warn("session " + id + ": another server continues it" + (at.empty() ? "" : ": " + at));
    registry->hand_over(id, "another server continues the session", at);
    const std::lock_guard lock(mutex);
    ending.erase(id);
  }
}

/// Follows the sessions of other servers, also those without an owner at present.
void ClusterNode::Impl::follow_others() {
  if (!followers) return;
  std::vector<std::string> ids, taken;
  std::int64_t known_ns = 0;
  {
    const std::lock_guard lock(mutex);
    if (holds || heard_ns == 0) return;
    known_ns = Clock::boot_ns();
    taken.assign(taking.begin(), taking.end());
    for (const PlacedSession& session : table.elsewhere()) {
      if (!taking.contains(session.id)) ids.push_back(session.id);
    }
  }
  std::erase_if(ids, [&](const std::string& id) { return own.find(id).has_value(); });
  followers->set_elsewhere(ids, taken, known_ns);
}

void ClusterNode::Impl::take_all(const std::stop_token& stop) {
  do {
    hand_over_lost();
    follow_others();
    while (const auto id = next_to_take()) {
      take(*id);
      hand_over_lost();
      const std::lock_guard lock(mutex);
      taking.erase(*id);
      if (stop.stop_requested()) return;
    }
  } while (pause(stop));
}

}  // namespace kerf
