// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/snapshot_copies.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>

#include "server/log/log.h"
#include "server/platform/clock.h"

namespace kerf {
namespace {

/// Polling interval of the snapshots of all sessions. A poll of one reads the time of a file.
constexpr std::chrono::milliseconds kSnapshotLook{200};
/// Same as the thread that writes the snapshots.
constexpr int kSnapshotNiceness = 5;

void pause(const std::stop_token& stop, Clock::duration time) {
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  wake.wait_for(lock, stop, time, [] { return false; });
}

}  // namespace

SnapshotCopies::SnapshotCopies(NatsConnection& nats, int replicas, SessionRegistry& registry)
    : nats_(nats),
      replicas_(replicas),
      registry_(registry),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

SnapshotCopies::~SnapshotCopies() = default;  // stops and joins the thread

void SnapshotCopies::run(const std::stop_token& stop) {
  setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), kSnapshotNiceness);
  while (!stop.stop_requested()) {
    follow_registry();
    for (auto& [id, copied] : copies_) {
      const auto begin = Clock::now();
      if (look_at(copied, stop)) pause(stop, Clock::now() - begin);
      if (stop.stop_requested()) return;
    }
    pause(stop, kSnapshotLook);
  }
}

void SnapshotCopies::follow_registry() {
  const auto sessions = registry_.list();
  std::erase_if(copies_, [&](const auto& entry) {
    const auto open = entry.second.session.lock();
    return !open || std::ranges::find(sessions, open) == sessions.end();
  });
  for (const auto& session : sessions) {
    if (copies_.contains(session->id())) continue;
    const SnapshotCopy::Source source{session->id(), session->journal_file(), session->epoch()};
    copies_[session->id()] = {
        session, std::make_unique<SnapshotCopy>(nats_, source, replicas_), {}};
  }
}

bool SnapshotCopies::look_at(Copied& copied, const std::stop_token& stop) {
  const auto session = copied.session.lock();
  if (!session) return false;
  const auto stored = copied.copy->copy(session->copy().record(), stop);
  session->copy().set_snapshot(copied.copy->record());
  const std::string fault = stored ? "" : stored.error();
  if (std::exchange(copied.fault, fault) != fault && !fault.empty()) {
    log::warn("session " + session->id() + ": its snapshots are not copied to NATS: " + fault);
  }
  return stored && *stored;
}

}  // namespace kerf
