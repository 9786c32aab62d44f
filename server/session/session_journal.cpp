// SPDX-License-Identifier: Apache-2.0
#include "server/session/session_journal.h"

#include <string>
#include <utility>

#include "server/session/pause_text.h"

namespace kerf {
namespace {

/// Number of pending records above which programs wait for the disk. A slice adds a few hundred.
constexpr std::size_t kProgramRecordsMax = kJournalBufferRecords / 4;

Rejection not_ours() { return {wire::ErrorCode::kNotAllowed, "another server runs the session"}; }

Rejection busy(const JournalError& error) {
  const bool is_full = error.code == JournalErrorCode::kFull;
  return {wire::ErrorCode::kBusy, is_full ? error.reason : pause_text(error)};
}

}  // namespace

SessionJournal::SessionJournal(JournalWriter writer, StateHash replayed)
    : writer_(std::move(writer)), removal_sequence_(replayed.sequence), hash_(replayed) {}

SessionJournal::SessionJournal(std::unique_ptr<FollowedJournal> followed, StateHash replayed)
    : followed_(std::move(followed)), removal_sequence_(replayed.sequence), hash_(replayed) {}

std::expected<void, Rejection> SessionJournal::append(ParticipantId participant,
                                                      const RecordedCommand& command,
                                                      RecordNote note) {
  if (!writer_) return std::unexpected(not_ours());
  const auto appended = writer_->append(participant, command, note);
  if (!appended) return std::unexpected(busy(appended.error()));
  return {};
}

std::expected<void, Rejection> SessionJournal::append(ParticipantId participant,
                                                      std::span<const RecordedCommand> changes) {
  if (!writer_) return std::unexpected(not_ours());
  const auto appended = writer_->append_together(participant, changes);
  if (!appended) return std::unexpected(busy(appended.error()));
  return {};
}

std::expected<void, Rejection> SessionJournal::check_space_for_programs() const {
  if (!writer_) return std::unexpected(not_ours());
  if (const auto error = writer_->pause()) {
    return std::unexpected(Rejection{wire::ErrorCode::kBusy, pause_text(*error)});
  }
  if (writer_->lag() < kProgramRecordsMax) return {};
  return std::unexpected(Rejection{wire::ErrorCode::kBusy, "the disk does not keep up"});
}

void SessionJournal::append(const Participant& participant, const std::optional<TokenHash>& token) {
  if (!writer_) return;
  writer_->append(JournalParticipant{participant.id, participant.name, participant.color,
                                     to_string(participant.kind), token});
}

void SessionJournal::append_removal(const Participant& participant) {
  if (!writer_) return;
  JournalParticipant removed{participant.id, participant.name, participant.color,
                             to_string(participant.kind)};
  removed.is_removed = true;
  writer_->append(removed);
}

std::expected<void, JournalError> SessionJournal::flush_and_copy() {
  if (auto flushed = flush(); !flushed || !writer_ || !needs_copy_) return flushed;
  if (copy_->wait_for(writer_->figures().commits, Clock::now() + kCopyPatience)) return {};
  return std::unexpected(not_copied());
}

JournalError SessionJournal::not_copied() const {
  const auto state = copy_->get();
  const std::string fault = state && !state->fault.empty() ? state->fault : "NATS does not keep up";
  return {JournalErrorCode::kNotCopied, file().string(), 0,
          "the change is stored on this server, but not yet on another one: " + fault +
              "; it may be lost with this server, so look whether it is there before repeating it"};
}

std::optional<StateHash> SessionJournal::current_hash() const {
  // Records after the last removal did not change the solid.
  if (!hash_ || hash_->sequence < removal_sequence_) return std::nullopt;
  return StateHash{sequence(), hash_->hash};
}

void SessionJournal::note_hash(StateHash state) {
  if (hash_ && hash_->sequence >= state.sequence) return;
  hash_ = state;
  if (writer_) writer_->append(state);
}

}  // namespace kerf
