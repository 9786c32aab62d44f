// SPDX-License-Identifier: Apache-2.0
#include "server/session/hash_keeper.h"

#include <algorithm>
#include <utility>

#include "server/platform/clock.h"

namespace kerf {
namespace {

/// State hashes are computed at least kHashInterval apart, and at least kHashCostFactor times the
/// duration of the previous computation.
constexpr std::chrono::microseconds kHashInterval{500'000};
constexpr int kHashCostFactor = 20;

}  // namespace

HashKeeper::HashKeeper(const Parts& parts, Executor& workers, SessionOwner owner,
                       std::function<bool()> is_between_records)
    : executor_(parts.executor),
      sculpture_(parts.sculpture),
      journal_(parts.journal),
      workers_(workers),
      owner_(std::move(owner)),
      is_between_records_(std::move(is_between_records)) {}

void HashKeeper::schedule() {
  if (std::exchange(is_scheduled_, true)) return;
  const auto delay = std::max(kHashInterval, kHashCostFactor * cost_);
  executor_.post_after(delay, [this, watched = owner_.watch()] {
    if (const auto session = watched.lock()) compute();
  });
}

void HashKeeper::compute() {
  is_scheduled_ = false;
  if (closed_ || journal_.current_hash()) return;
  if (is_between_records_()) return schedule();
  workers_.post([this, session = owner_.hold(), solid = sculpture_.solid(),
                 at = journal_.sequence()] {
    const auto start = Clock::now();
    const std::uint64_t hash = solid.hash();
    const auto cost = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - start);
    executor_.post([this, session, at, hash, cost] {
      cost_ = cost;
      note({at, hash});
    });
  });
}

void HashKeeper::note(StateHash state) {
  if (!closed_) journal_.note_hash(state);
}

}  // namespace kerf
