// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/replication.h"

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

#include "server/cluster/journal_replica.h"
#include "server/cluster/nats_address.h"
#include "server/cluster/nats_connection.h"
#include "server/cluster/snapshot_copies.h"
#include "server/log/log.h"

namespace kerf {
namespace {

/// Polling interval of the sessions. A poll of one reads two counters.
constexpr std::chrono::milliseconds kLook{10};

}  // namespace

struct Replication::Impl {
  struct Copied {
    std::string id;
    std::weak_ptr<Session> session;
    std::uint64_t commits = 0;
    std::unique_ptr<JournalReplica> replica;
  };

  Impl(NatsConnection connection, int count, SessionRegistry& sessions)
      : nats(std::move(connection)), replicas(count), registry(sessions) {}

  void run(const std::stop_token& stop) {
    std::mutex mutex;
    std::condition_variable_any wake;
    std::unique_lock lock(mutex);
    while (!stop.stop_requested()) {
      look();
      wake.wait_for(lock, stop, kLook, [] { return false; });
    }
  }

  void look() {
    const auto sessions = registry.list();
    std::erase_if(copies, [&](const Copied& copied) {
      const auto session = copied.session.lock();
      return !session || std::ranges::find(sessions, session) == sessions.end();
    });
    for (const auto& session : sessions) {
      const std::uint64_t commits = session->journal_figures().commits;
      const auto known = std::ranges::find_if(copies, [&](const Copied& copied) {
        return !copied.session.owner_before(session) && !session.owner_before(copied.session);
      });
      if (known == copies.end()) {
        add(session, commits);
      } else if (std::exchange(known->commits, commits) != commits) {
        known->replica->wake();
      }
    }
  }

  void add(const std::shared_ptr<Session>& session, std::uint64_t commits) {
    const auto report = [weak = std::weak_ptr(session)](const CopyState& state) {
      if (const auto open = weak.lock()) open->copy().set(state);
    };
    const auto count = [weak = std::weak_ptr(session)] {
      const auto open = weak.lock();
      return open ? open->journal_figures().commits : 0;
    };
    session->copy().set(kNoCopyYet);
    copies.push_back({session->id(), session, commits,
                      std::make_unique<JournalReplica>(
                          nats,
                          JournalReplica::Source{session->id(), session->journal_file(),
                                                 session->epoch(), count},
                          replicas, report)});
  }

  NatsConnection nats;
  int replicas;
  SessionRegistry& registry;
  std::vector<Copied> copies;  ///< watcher's thread only, while it runs
  std::jthread watcher;
  std::unique_ptr<SnapshotCopies> snapshots;
};

Replication::Replication(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Replication::~Replication() { hold(); }

std::expected<std::unique_ptr<Replication>, std::string> Replication::start(
    const ReplicationOptions& options, SessionRegistry& registry) {
  auto nats = NatsConnection::open(options.url, "kerf-server");
  const std::string shown = without_credentials(options.url);
  if (!nats) return std::unexpected(shown + ": " + nats.error().reason);
  if (!nats->is_connected()) {
    log::warn("NATS cannot be reached at " + shown +
              ": the journals are copied as soon as it can be");
  }
  auto impl = std::make_unique<Impl>(*std::move(nats), options.replicas, registry);
  impl->watcher = std::jthread([raw = impl.get()](const std::stop_token& stop) { raw->run(stop); });
  impl->snapshots = std::make_unique<SnapshotCopies>(impl->nats, options.replicas, registry);
  return std::unique_ptr<Replication>(new Replication(std::move(impl)));
}

void Replication::hold() {
  if (!impl_->watcher.joinable()) return;
  impl_->watcher = {};
  impl_->snapshots->stop();  // a stopping server does not wait for the current message
  impl_->look();             // sessions newer than the last poll are copied too
}

std::vector<std::string> Replication::finish(Clock::time_point end) {
  hold();
  std::vector<std::string> unfinished;
  for (const auto& copied : impl_->copies) {
    if (!copied.replica->finish(end)) unfinished.push_back(copied.id);
  }
  impl_->copies.clear();
  return unfinished;
}

}  // namespace kerf
