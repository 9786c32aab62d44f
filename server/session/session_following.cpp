// SPDX-License-Identifier: Apache-2.0
// The part of SessionRegistry with the sessions that other servers run.
#include <utility>

#include "server/platform/random.h"
#include "server/session/session_registry.h"
#include "server/store/journal_times.h"

namespace kerf {
namespace {

/// Returns the first id for a follower's viewers: each run of a server gets 65,536 ids.
ParticipantId first_viewer_id() {
  constexpr ParticipantId kSpan = 0x1'0000, kSpans = 0x2000;
  return kFollowerIds + kSpan * static_cast<ParticipantId>(random_number() % kSpans);
}

}  // namespace

std::expected<std::shared_ptr<Session>, JournalError> SessionRegistry::follow(
    const std::string& id) {
  const auto file = journal_path(id);
  auto replayed = restore(file, stop_loading_.get_token());
  if (!replayed) return std::unexpected(replayed.error());
  replayed->last_participant = first_viewer_id();
  replayed->resumable = {};
  const std::uint64_t last = std::max<std::uint64_t>(replayed->last_sequence, 1);
  const std::int64_t created_ms = time_of(file, 1).value_or(0);
  const std::int64_t active_ms = std::max(created_ms, time_of(file, last).value_or(0));
  auto followed = std::make_unique<FollowedJournal>();
  followed->file = file;
  followed->epoch = replayed->header.epoch;
  followed->sequence = replayed->last_sequence;
  SessionJournal journal(std::move(followed), replayed->hash);
  auto session =
      std::make_shared<Session>(id, *std::move(replayed), std::move(journal), options_.session,
                                make_executor_(id), workers_, options_.matters);
  session->note_times(created_ms, active_ms);
  session->place_in(options_.places, false);
  if (options_.snapshots.writer != nullptr) session->keep_snapshots(options_.snapshots);
  if (auto ok = note_attachments(*session); !ok) {
    return std::unexpected(JournalError{JournalErrorCode::kIo, file.string(), 0, ok.error()});
  }
  const std::lock_guard lock(mutex_);
  followed_[id] = session;
  return session;
}

std::expected<void, std::string> SessionRegistry::note_attachments(Session& followed) const {
  return call_opened(followed, Opening::kFollowed);
}

void SessionRegistry::end_following(const std::string& id, const std::string& reason,
                                    const std::string& redirect) {
  std::shared_ptr<Session> session;
  {
    const std::lock_guard lock(mutex_);
    const auto found = followed_.find(id);
    if (found == followed_.end()) return;
    session = std::move(found->second);
    followed_.erase(found);
  }
  end(session, reason, redirect);
  (void)session->finish_journal(true);  // nothing of a followed journal waits to be written
}

std::vector<std::string> SessionRegistry::followed() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> ids;
  for (const auto& [id, session] : followed_) ids.push_back(id);
  return ids;
}

std::shared_ptr<Session> SessionRegistry::find_followed(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = followed_.find(id);
  return found == followed_.end() ? nullptr : found->second;
}

}  // namespace kerf
