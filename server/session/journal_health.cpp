// SPDX-License-Identifier: Apache-2.0
#include "server/session/journal_health.h"

#include <utility>

namespace kerf {
namespace {

/// Bytes that find_damage() reads at a time. Closing a session waits for at most one part.
constexpr std::size_t kFoundBytes = std::size_t{4} << 20;

}  // namespace

std::optional<JournalError> JournalHealth::damage() const {
  const std::lock_guard lock(mutex_);
  return damage_;
}

void JournalHealth::note(const JournalError& damage) {
  {
    const std::lock_guard lock(mutex_);
    if (damage_) return;
    damage_ = damage;
  }
  if (report_) report_(damage);
}

std::expected<bool, JournalError> JournalHealth::advance(JournalScan& scan, std::size_t bytes,
                                                         const std::stop_token& stop) {
  const std::lock_guard lock(reading_);
  if (has_ended_) {
    return std::unexpected(JournalError{JournalErrorCode::kIo, {}, 0, "the journal is closed"});
  }
  auto done = scan.advance(bytes, stop);
  if (!done && done.error().code == JournalErrorCode::kCorrupt) note(done.error());
  return done;
}

std::optional<JournalError> JournalHealth::find_damage(const std::filesystem::path& file,
                                                       const std::stop_token& stop) {
  if (auto known = damage()) return known;
  JournalScan scan(file);
  for (;;) {
    const auto done = advance(scan, kFoundBytes, stop);
    if (!done || *done) return damage();
  }
}

void JournalHealth::end() {
  const std::lock_guard lock(reading_);
  has_ended_ = true;
}

}  // namespace kerf
