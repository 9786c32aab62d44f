// SPDX-License-Identifier: Apache-2.0
#include "server/session/journal_watch.h"

#include <algorithm>
#include <exception>
#include <map>
#include <mutex>
#include <stop_token>
#include <utility>

#include "server/store/journal_scan.h"

namespace kerf {
namespace {

/// Session id and epoch: a reopened session has a journal of another epoch.
using Key = std::pair<std::string, std::uint32_t>;

struct Pass {
  JournalScan scan;
  Clock::time_point due;  ///< when the next part or pass is due
};

}  // namespace

struct JournalWatch::Impl : std::enable_shared_from_this<Impl> {
  Impl(SessionRegistry& sessions, Executor& thread, WatchOptions how)
      : registry(sessions), executor(thread), options(std::move(how)) {}

  void post(std::chrono::microseconds delay) {
    executor.post_after(delay, [weak = weak_from_this()] {
      if (const auto self = weak.lock()) self->run();
    });
  }

  void run() {
    const std::lock_guard lock(mutex);
    if (stopping.stop_requested()) return;
    const auto begun = options.now();
    bool has_worked = false;
    try {
      has_worked = verify_part();
    } catch (const std::exception&) {  // e.g. not enough memory: retry later
    }
    const auto took = std::chrono::duration_cast<std::chrono::microseconds>(options.now() - begun);
    post(has_worked ? std::max(options.pause, options.pause_factor * took) : options.idle);
  }

  /// Forgets closed sessions and adds newly opened ones.
  std::map<Key, std::shared_ptr<Session>> update_passes() {
    std::map<Key, std::shared_ptr<Session>> open;
    for (auto& session : registry.list()) {
      Key key{session->id(), session->epoch()};
      passes.try_emplace(key, JournalScan(session->journal_file()), options.now());
      open.emplace(std::move(key), std::move(session));
    }
    std::erase_if(passes, [&](const auto& pass) { return !open.contains(pass.first); });
    return open;
  }

  /// Verifies a part of the session that has waited longest. Returns false if none is due.
  bool verify_part() {
    auto open = update_passes();
    const auto next =
        std::ranges::min_element(passes, {}, [](const auto& pass) { return pass.second.due; });
    if (next == passes.end() || next->second.due > options.now()) return false;
    Pass& pass = next->second;
    Session& session = *open.at(next->first);
    pass.due = options.now() + options.retry;  // also after an exception
    const auto done = session.health().advance(pass.scan, options.part_bytes, stopping.get_token());
    const bool is_damaged = !done && done.error().code == JournalErrorCode::kCorrupt;
    if (!done && !is_damaged) return true;  // a failing disk: repeat this part later
    pass.due = options.now();
    const bool has_ended = is_damaged || *done;
    if (has_ended) pass = {JournalScan(session.journal_file()), pass.due + options.again};
    return true;
  }

  SessionRegistry& registry;
  Executor& executor;
  const WatchOptions options;
  std::stop_source stopping;
  std::mutex mutex;  ///< held while a part is verified; guards the next
  std::map<Key, Pass> passes;
};

JournalWatch::JournalWatch(SessionRegistry& registry, Executor& executor, WatchOptions options)
    : impl_(std::make_shared<Impl>(registry, executor, std::move(options))) {}

JournalWatch::~JournalWatch() { stop(); }

void JournalWatch::start() { impl_->post({}); }

void JournalWatch::stop() {
  impl_->stopping.request_stop();
  const std::lock_guard wait_for_part(impl_->mutex);
}

}  // namespace kerf
