// SPDX-License-Identifier: Apache-2.0
// The part of SessionRegistry that opens the sessions of the data folder.
#include <algorithm>
#include <exception>
#include <system_error>
#include <utility>

#include "server/session/session_registry.h"
#include "server/store/block_snapshot.h"
#include "server/store/chunk_file.h"
#include "server/store/journal_branch.h"
#include "server/store/journal_times.h"

namespace kerf {

std::expected<std::shared_ptr<Session>, JournalError> SessionRegistry::start(
    const std::string& id, Opened& opened, Opening opening, const std::stop_token& stop) {
  const auto file = journal_path(id);
  std::error_code often_absent;
  std::filesystem::remove(unfinished_file(snapshot_file(file)), often_absent);
  auto replayed = restore(file, stop);
  if (!replayed) return std::unexpected(replayed.error());
  if (options_.places != nullptr) {
    if (auto ok = raise_epoch(file, options_.places->epoch(id)); !ok) {
      return std::unexpected(ok.error());
    }
  }
  auto journal = JournalWriter::open(file, replayed->last_sequence);
  if (!journal) return std::unexpected(journal.error());
  if (options_.places != nullptr) journal->keep_within(options_.places->fence(id));
  opened = {replayed->header.kernel_version, replayed->last_sequence, replayed->dropped_hashes > 0,
            replayed->snapshot_fault, replayed->snapshot_sequence};
  if (options_.on_pause) {
    journal->on_pause([id, report = options_.on_pause](const auto& error) { report(id, error); });
  }
  if (replayed->is_recarved()) journal->append_recarved(replayed->hash);
  // The first records define the tools. Without a record there is no time.
  const std::uint64_t last = std::max<std::uint64_t>(replayed->last_sequence, 1);
  const JournalParent& parent = replayed->parent;
  const std::int64_t created_ms =
      parent.session.empty() ? time_of(file, 1).value_or(0) : parent.branched_ms;
  const std::int64_t active_ms = std::max(created_ms, time_of(file, last).value_or(0));
  SessionJournal kept(*std::move(journal), replayed->hash);
  auto session =
      std::make_shared<Session>(id, *std::move(replayed), std::move(kept), options_.session,
                                make_executor_(id), workers_, options_.matters);
  session->note_times(created_ms, active_ms);
  if (options_.on_damage) {
    session->health().report_to(
        [id, report = options_.on_damage](const JournalError& damage) { report(id, damage); });
  }
  session->place_in(options_.places, options_.needs_copy);
  if (options_.carvers != nullptr) session->carve_on(*options_.carvers);
  if (options_.snapshots.writer != nullptr) session->keep_snapshots(options_.snapshots);
  if (auto ok = call_opened(*session, opening); !ok) {
    return std::unexpected(JournalError{JournalErrorCode::kIo, file.string(), 0, ok.error()});
  }
  return session;
}

std::expected<void, std::string> SessionRegistry::call_opened(Session& session,
                                                              Opening opening) const {
  if (!hooks_.opened) return {};
  return hooks_.opened(session, opening);
}

std::expected<void, JournalError> SessionRegistry::find_journals() {
  std::vector<std::string> ids;
  std::vector<std::filesystem::path> unfinished;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(options_.data_folder, error)) {
    const std::string id = entry.path().stem().string();
    if (entry.path().extension() == kJournalExtension && is_session_id(id)) ids.push_back(id);
    if (is_unfinished_branch(entry.path())) unfinished.push_back(entry.path());
  }
  for (const auto& file : unfinished) remove_journal(file);
  std::ranges::sort(ids);
  const std::lock_guard lock(mutex_);
  for (std::string& id : ids) {
    if (sessions_.contains(id) || !loading_.insert(id).second) continue;
    waiting_.push_back(std::move(id));
  }
  found_ = true;
  if (!error) return {};
  return std::unexpected(
      JournalError{JournalErrorCode::kIo, options_.data_folder.string(), 0, error.message()});
}

LoadReport SessionRegistry::load_all() {
  LoadReport report;
  if (const auto found = find_journals(); !found) report.failures.push_back(found.error());
  while (load_next(report)) {
  }
  return report;
}

bool SessionRegistry::load_next(LoadReport& report) {
  std::string id;
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.empty()) return false;
    id = std::move(waiting_.front());
    waiting_.pop_front();
  }
  open(id, report);
  return true;
}

void SessionRegistry::load(const std::string& id, LoadReport& report) {
  const auto failed = [&](JournalErrorCode code, const std::exception& error) {
    note_unreadable({code, journal_path(id).string(), 0, error.what()}, id, report);
  };
  try {
    Opened opened;
    if (auto session = start(id, opened, Opening::kLoaded, stop_loading_.get_token())) {
      note_loaded(*std::move(session), opened, report);
    } else {
      note_unreadable(session.error(), id, report);
    }
  } catch (const std::system_error& error) {  // of the operating system
    failed(JournalErrorCode::kIo, error);
  } catch (const std::exception& error) {  // e.g. not enough memory for this block
    failed(JournalErrorCode::kNotLoaded, error);
  }
}

void SessionRegistry::note_unreadable(const JournalError& error, const std::string& id,
                                      LoadReport& report) {
  const std::lock_guard lock(mutex_);
  unreadable_.erase(id);
  if (stop_loading_.stop_requested()) return;
  report.failures.push_back(error);
  // The operator may have moved it away.
  if (error.code != JournalErrorCode::kNotFound) unreadable_[id] = error;
}

void SessionRegistry::note_loaded(std::shared_ptr<Session> session, const Opened& opened,
                                  LoadReport& report) {
  const std::string& id = session->id();
  const std::lock_guard lock(mutex_);
  unreadable_.erase(id);
  if (opened.kernel_version != kKernelVersion) {
    report.recarved.push_back({id, opened.kernel_version});
  }
  if (opened.shortened) report.shortened.push_back({id, opened.last_sequence});
  if (!opened.snapshot_fault.empty()) {
    report.ignored.push_back({id, opened.snapshot_fault, opened.snapshot_sequence});
  }
  report.loaded.push_back(id);
  sessions_[id] = std::move(session);
}

void SessionRegistry::open_one_by_one() {
  const std::lock_guard lock(mutex_);
  found_ = true;
}

void SessionRegistry::expect(const std::string& id) {
  const std::lock_guard lock(mutex_);
  loading_.insert(id);
}

bool SessionRegistry::is_reserved(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = sessions_.find(id);
  return loading_.contains(id) || (found != sessions_.end() && !found->second);
}

void SessionRegistry::give_up(const std::string& id) {
  const std::lock_guard lock(mutex_);
  loading_.erase(id);
}

void SessionRegistry::open(const std::string& id, LoadReport& report) {
  load(id, report);
  give_up(id);
}

void SessionRegistry::hasten(const std::string& id) {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find(waiting_, id);
  if (found != waiting_.end()) std::rotate(waiting_.begin(), found, found + 1);
}

void SessionRegistry::stop_loading() {
  stop_loading_.request_stop();
  const std::lock_guard lock(mutex_);
  for (const std::string& id : waiting_) loading_.erase(id);
  waiting_.clear();
}

bool SessionRegistry::is_loading(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  return loading_.contains(id);
}

std::vector<std::string> SessionRegistry::loading() const {
  const std::lock_guard lock(mutex_);
  return {loading_.begin(), loading_.end()};
}

std::vector<std::string> SessionRegistry::retry_disk_failures() {
  std::vector<std::string> started;
  for (const UnreadableSession& session : unreadable()) {
    if (session.error.code != JournalErrorCode::kIo) continue;
    LoadReport report;
    load(session.id, report);
    if (!report.loaded.empty()) started.push_back(session.id);
  }
  return started;
}

bool SessionRegistry::loaded() const {
  const std::lock_guard lock(mutex_);
  return found_ && loading_.empty();
}

std::vector<UnreadableSession> SessionRegistry::unreadable() const {
  const std::lock_guard lock(mutex_);
  std::vector<UnreadableSession> list;
  list.reserve(unreadable_.size());
  for (const auto& [id, error] : unreadable_) list.push_back({id, error});
  return list;
}

std::optional<JournalError> SessionRegistry::unreadable(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = unreadable_.find(id);
  return found == unreadable_.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace kerf
