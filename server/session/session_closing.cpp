// SPDX-License-Identifier: Apache-2.0
// The part of SessionRegistry that closes sessions, lists the closed ones and reopens them.
#include <algorithm>
#include <charconv>
#include <string_view>
#include <system_error>
#include <utility>

#include "server/platform/clock.h"
#include "server/session/session_registry.h"
#include "server/store/private_file.h"
#include "server/threads/run_and_wait.h"

namespace kerf {
namespace {

RegistryError no_closed_session(const std::string& name) {
  return {RegistryErrorCode::kUnknown, "no closed session has the name " + name, {}};
}

/// s since 1970. A smaller number at the end of a name is a counter for files of the same second.
constexpr std::int64_t kSecondsMin = 1'000'000'000;

/// Removes "-NUMBER" from the end of a name and returns the number; 0 if the name has none.
std::int64_t take_number(std::string_view& name) {
  const std::size_t dash = name.rfind('-');
  if (dash == std::string_view::npos || dash == 0) return 0;
  std::int64_t number = 0;
  const char* end = name.data() + name.size();
  const auto parsed = std::from_chars(name.data() + dash + 1, end, number);
  if (parsed.ec != std::errc() || parsed.ptr != end) return 0;
  name = name.substr(0, dash);
  return number;
}

/// Parses the name of a closed session, ID-SECONDS or ID-SECONDS-N. Any other name, e.g. of a file
/// that somebody has put there, is the id.
ClosedSession parse_name(const std::string& name) {
  std::string_view id = name;
  std::int64_t seconds = take_number(id);
  if (seconds < kSecondsMin) seconds = take_number(id);
  if (seconds < kSecondsMin) return {name, name, 0, 0};
  return {name, std::string(id), seconds, 0};
}

}  // namespace

std::string stays_open(const JournalError& error) {
  return "the session stays open and loses nothing, because its records cannot be stored: " +
         describe(error);
}

std::filesystem::path SessionRegistry::closed_folder() const {
  return options_.data_folder / kClosedFolder;
}

std::expected<void, RegistryError> SessionRegistry::close(const std::string& id, bool purge) {
  const auto not_closed = [](const JournalError& error) {
    return std::unexpected(RegistryError{RegistryErrorCode::kNotClosed, stays_open(error), {}});
  };
  if (!purge) {  // while the session is still visible: this may wait for the disk
    const auto open = find(id);
    if (const auto flushed = open ? open->flush() : std::expected<void, JournalError>(); !flushed) {
      return not_closed(flushed.error());
    }
    if (const auto error = create_private_folder(closed_folder())) {
      return not_closed({JournalErrorCode::kIo, closed_folder().string(), 0, error.message()});
    }
  }
  std::shared_ptr<Session> session;
  {
    const std::lock_guard lock(mutex_);
    const auto found = sessions_.find(id);
    if (found == sessions_.end() || !found->second) {
      return std::unexpected(
          RegistryError{RegistryErrorCode::kUnknown, "unknown session " + id, {}});
    }
    session = std::move(found->second);
    found->second = nullptr;  // the id stays reserved until the file has been moved
  }
  if (const auto ended = end_committed(session, purge); !ended) {
    const std::lock_guard lock(mutex_);
    sessions_[id] = session;
    return not_closed(ended.error());
  }
  // All records are committed. An error could only lose hashes and notes about programs.
  (void)session->finish_journal();
  session.reset();
  return put_away(id, purge);
}

/// Ends a session after committing its records, in one turn of its executor, so that nothing is
/// accepted in between. After an error the session continues. With `purge` nothing needs to be
/// committed.
std::expected<void, JournalError> SessionRegistry::end_committed(
    const std::shared_ptr<Session>& session, bool purge) {
  return run_and_wait(session->executor(), [&]() -> std::expected<void, JournalError> {
    if (auto ok = purge ? std::expected<void, JournalError>() : session->flush(); !ok) return ok;
    session->close("the session was closed by its operator");
    return {};
  });
}

/// Moves the journal of an ended session to `closed` and states its end to the cluster.
std::expected<void, RegistryError> SessionRegistry::move_to_closed(const std::string& id) {
  const auto kept =
      keep_journal(journal_path(id), closed_folder(), id + "-" + std::to_string(Clock::wall_s()));
  if (!kept) {
    return std::unexpected(RegistryError{
        RegistryErrorCode::kNotClosed,
        "the session was opened again and loses nothing, because its journal cannot be moved to " +
            closed_folder().string() + ": " + kept.error().message(),
        {}});
  }
  auto stated = state_end(id);
  if (!stated) (void)keep_journal(*kept, options_.data_folder, id);
  return stated;
}

/// States to the cluster that a session has ended. Otherwise another server would continue it.
std::expected<void, RegistryError> SessionRegistry::state_end(const std::string& id) {
  if (options_.places == nullptr) return {};
  const auto stated = options_.places->close(id);
  if (stated) return {};
  return std::unexpected(RegistryError{
      RegistryErrorCode::kNoLease,
      "the session was opened again and loses nothing, because the other servers cannot be told "
      "that it is closed: " +
          stated.error(),
      {}});
}

/// Moves or deletes the journal of an ended session. After an error the session is opened again.
std::expected<void, RegistryError> SessionRegistry::put_away(const std::string& id, bool purge) {
  const auto away = purge ? state_end(id) : move_to_closed(id);
  if (away && purge) remove_journal(journal_path(id));
  if (!away) {
    LoadReport ignored;
    load(id, ignored);  // if this fails too, the session is listed as unreadable
  }
  const std::lock_guard lock(mutex_);
  if (!sessions_[id]) sessions_.erase(id);
  return away;
}

void SessionRegistry::hand_over(const std::string& id, const std::string& reason,
                                const std::string& redirect) {
  std::shared_ptr<Session> session;
  {
    const std::lock_guard lock(mutex_);
    const auto found = sessions_.find(id);
    if (found == sessions_.end() || !found->second) return;
    session = std::move(found->second);
    found->second = nullptr;  // the id stays reserved until the file is closed
  }
  end(session, reason, redirect);
  (void)session->finish_journal();  // records lost here are unknown to the other server as well
  if (hooks_.left) hooks_.left(id);
  const std::lock_guard lock(mutex_);
  sessions_.erase(id);
}

std::vector<ClosedSession> SessionRegistry::closed() const {
  std::vector<ClosedSession> list;
  std::error_code absent;
  for (const auto& entry : std::filesystem::directory_iterator(closed_folder(), absent)) {
    if (entry.path().extension() != kJournalExtension) continue;
    ClosedSession session = parse_name(entry.path().stem().string());
    session.bytes = session_bytes(entry.path());
    list.push_back(std::move(session));
  }
  std::ranges::sort(list, {}, &ClosedSession::name);
  return list;
}

std::expected<std::filesystem::path, RegistryError> SessionRegistry::find_closed(
    const std::string& name) const {
  const auto sessions = closed();  // a name in the folder cannot be a path
  if (std::ranges::find(sessions, name, &ClosedSession::name) == sessions.end()) {
    return std::unexpected(no_closed_session(name));
  }
  return closed_folder() / (name + kJournalExtension);
}

SessionRegistry::ClosedFile::ClosedFile(SessionRegistry& registry, const std::string& name)
    : registry_(registry), name_(name) {
  std::unique_lock lock(registry_.mutex_);
  registry_.closed_free_.wait(lock, [&] { return registry_.closed_in_use_.insert(name).second; });
}

SessionRegistry::ClosedFile::~ClosedFile() {
  {
    const std::lock_guard lock(registry_.mutex_);
    registry_.closed_in_use_.erase(name_);
  }
  registry_.closed_free_.notify_all();
}

std::expected<void, RegistryError> SessionRegistry::delete_closed(const std::string& name) {
  const ClosedFile mine(*this, name);
  const auto file = find_closed(name);
  if (!file) return std::unexpected(file.error());
  remove_journal(*file);
  std::error_code error;
  if (!std::filesystem::exists(*file, error)) return {};
  return std::unexpected(
      RegistryError{RegistryErrorCode::kJournal, "the file of " + name + " cannot be deleted", {}});
}

std::expected<std::shared_ptr<Session>, RegistryError> SessionRegistry::reopen(
    const std::string& name, LoadReport& report) {
  const ClosedFile mine(*this, name);
  const auto file = find_closed(name);
  if (!file) return std::unexpected(file.error());
  const std::string id = parse_name(name).id;
  if (!is_session_id(id)) {
    return std::unexpected(
        RegistryError{RegistryErrorCode::kBadId, name + " does not name a session", {}});
  }
  const auto reserved = reserve(id, {}, true);
  if (!reserved) return std::unexpected(reserved.error());
  const auto moved = keep_journal(*file, options_.data_folder, id);
  if (moved) load(id, report);
  const std::lock_guard lock(mutex_);
  if (auto session = sessions_[id]) return session;
  unreadable_.erase(id);
  if (!moved) {
    return std::unexpected(RegistryError{
        RegistryErrorCode::kJournal, file->string() + ": " + moved.error().message(), {}});
  }
  // Move the journal back. If that fails too, it is loaded at the next start.
  (void)keep_journal(*moved, closed_folder(), name);
  if (!report.failures.empty()) return std::unexpected(registry_error(report.failures.back()));
  return std::unexpected(
      RegistryError{RegistryErrorCode::kDiskFails, "the server is stopping", {}});
}

}  // namespace kerf
