// SPDX-License-Identifier: Apache-2.0
#include "server/store/journal_writer.h"

#include <pthread.h>

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "server/platform/clock.h"
#include "server/store/journal_group.h"
#include "server/store/record_origins.h"

namespace kerf {

namespace {

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Stores that the records after `last` are those of a new writer (record_origins.h), instead of
/// those that a crash has taken back.
SqlResult<void> begin_writer(SqlDatabase& database, std::uint64_t last) {
  const auto lists = read_lists(database, last);
  if (!lists) return std::unexpected(lists.error());
  const auto rows = lists->find(kOriginsTable);
  const RecordOrigins origins({}, {}, rows->second, last);
  if (auto ok = database.execute("BEGIN;DELETE FROM origins WHERE first>" + std::to_string(last));
      !ok) {
    return ok;
  }
  auto row = to_row(new_writer(last + 1, origins.next_clock()));
  if (auto ok = store_list_change(database, {.table = kOriginsTable, .stored = std::move(row)});
      !ok) {
    return ok;
  }
  return database.execute("COMMIT");
}

}  // namespace

struct JournalWriter::Impl {
  Impl(std::filesystem::path path, JournalGroups journal_groups, std::uint64_t last,
       std::uint32_t opened)
      : file(std::move(path)),
        groups(std::move(journal_groups)),
        epoch(opened),
        last_sequence(last),
        durable_sequence(last) {
    flusher = std::thread([this] { run(); });
    pthread_setname_np(flusher.native_handle(), "journal");
  }
  ~Impl() { stop(); }

  /// Commits the pending records if possible and joins the flusher.
  void stop() {
    {
      const std::lock_guard lock(mutex);
      stopping = true;
    }
    wake.notify_all();
    if (flusher.joinable()) flusher.join();
  }

  void push(Pending item) {
    const std::lock_guard lock(mutex);
    const bool was_empty = buffer.empty();
    buffer.push_back(std::move(item));
    note_pushed(was_empty, 1);
  }

  /// Appends all commands or, e.g. without memory, none. The flusher also takes all or none.
  std::expected<std::uint64_t, JournalError> append(ParticipantId participant,
                                                    std::span<const RecordedCommand> commands,
                                                    RecordNote note) {
    const std::lock_guard lock(mutex);
    if (auto error = obstacle()) return std::unexpected(*std::move(error));
    if (buffer.size() + in_commit + commands.size() > kJournalBufferRecords) {
      return std::unexpected(JournalError{
          JournalErrorCode::kFull, file.string(), 0,
          "the disk does not keep up: " + std::to_string(buffer.size() + in_commit) + " of " +
              std::to_string(kJournalBufferRecords) + " records are pending"});
    }
    const std::size_t before = buffer.size();
    const std::int64_t now_ms = Clock::wall_ms();
    std::uint64_t sequence = last_sequence;
    try {
      for (const RecordedCommand& command : commands) {
        buffer.emplace_back(PendingCommand{++sequence, participant, command, note, now_ms});
      }
    } catch (...) {
      buffer.erase(buffer.begin() + static_cast<std::ptrdiff_t>(before), buffer.end());
      throw;
    }
    last_sequence = sequence;
    note_pushed(before == 0, commands.size());
    return sequence;
  }

  void note_pushed(bool was_empty, std::size_t rows) {
    pushed += rows;
    if (!was_empty) return;
    buffer_since = Clock::now();
    // A flusher that is collecting a group wakes up by itself. Only an idle one must be notified.
    wake.notify_one();
  }

  void run() {
    std::unique_lock lock(mutex);
    std::vector<Pending> group;
    for (;;) {
      if (group.empty()) {
        wake.wait(lock, [&] { return stopping || !buffer.empty(); });
        if (buffer.empty()) return;
        wake.wait_for(lock, kGroupCommit, [&] { return stopping || flushing > 0; });
        group = std::exchange(buffer, {});
        group_since = buffer_since;
      } else {
        wake.wait_for(lock, kJournalRetry, [&] { return stopping || retry_now; });
      }
      retry_now = false;
      in_commit = group.size();
      const bool is_last_try = stopping;
      const bool again = failure.has_value();
      lock.unlock();
      const auto start = Clock::now();
      const auto outcome = again ? groups->commit_again(group) : groups->commit(group);
      const double seconds = seconds_since(start);
      lock.lock();
      figures.commit_s += seconds;
      ++(outcome ? figures.commits : figures.failed_commits);
      if (outcome) {
        committed += group.size();
        note_durable(group);
        in_commit = 0;
        group.clear();
      }
      note_outcome(outcome, lock);
      if (!outcome && is_last_try) return;
    }
  }

  void note_durable(const std::vector<Pending>& group) {
    for (auto item = group.rbegin(); item != group.rend(); ++item) {
      if (const auto* command = std::get_if<PendingCommand>(&*item)) {
        return durable_sequence.store(command->sequence);
      }
    }
  }

  /// Wakes waiting threads and reports the begin and end of a pause.
  void note_outcome(const SqlResult<void>& outcome, std::unique_lock<std::mutex>& lock) {
    const bool was_paused = disk_pause().has_value();
    failure = outcome ? std::nullopt : std::optional(to_journal_error(file, outcome.error()));
    done.notify_all();
    report_change(was_paused, lock);
  }

  void report_change(bool was_paused, std::unique_lock<std::mutex>& lock) const {
    const auto error = disk_pause();
    if (was_paused == error.has_value() || !report) return;
    const auto call = report;
    lock.unlock();
    call(error);
    lock.lock();
  }

  const std::optional<JournalError>& disk_pause() const { return failure ? failure : held; }
  std::optional<JournalError> pause() const {
    if (disk_pause() || !fence || fence->is_open()) return disk_pause();
    return JournalError{JournalErrorCode::kLease, file.string(), 0,
                        "the lease of the session could not be renewed: another server may "
                        "continue it"};
  }

  /// Returns the error with which append() and flush() currently fail.
  std::optional<JournalError> obstacle() const {
    if (!closed) return pause();
    return JournalError{JournalErrorCode::kIo, file.string(), 0, "the journal is closed"};
  }

  std::filesystem::path file;
  std::optional<JournalGroups> groups;
  std::uint32_t epoch;

  mutable std::mutex mutex;
  std::condition_variable wake, done;
  std::vector<Pending> buffer;
  std::size_t in_commit = 0;                    ///< number of rows in the group being committed
  Clock::time_point buffer_since, group_since;  ///< when their oldest rows were appended
  std::uint64_t pushed = 0, committed = 0;
  JournalFigures figures;  ///< except the age of the oldest record
  int flushing = 0;
  bool stopping = false, closed = false, retry_now = false;
  std::optional<JournalError> failure;  ///< error of the last commit
  std::optional<JournalError> held;
  std::shared_ptr<const WriteFence> fence;  ///< null without a fence; set before the first append
  std::function<void(const std::optional<JournalError>&)> report;
  std::uint64_t last_sequence;
  std::atomic<std::uint64_t> durable_sequence;
  std::thread flusher;
};

JournalWriter::JournalWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
JournalWriter::JournalWriter(JournalWriter&&) noexcept = default;
JournalWriter& JournalWriter::operator=(JournalWriter&&) noexcept = default;
JournalWriter::~JournalWriter() = default;

std::expected<JournalWriter, JournalError> JournalWriter::create(const std::filesystem::path& file,
                                                                 const JournalHeader& header) {
  auto database = create_journal(file, header);
  if (!database) return std::unexpected(database.error());
  if (auto ok = begin_writer(*database, 0); !ok) {
    return std::unexpected(to_journal_error(file, ok.error()));
  }
  auto groups = JournalGroups::prepare(*std::move(database));
  if (!groups) return std::unexpected(to_journal_error(file, groups.error()));
  return JournalWriter(std::make_unique<Impl>(file, *std::move(groups), 0, 1));
}

std::expected<JournalWriter, JournalError> JournalWriter::open(const std::filesystem::path& file,
                                                               std::uint64_t last_sequence) {
  auto database = open_journal(file, SqlMode::kWrite);
  if (!database) return std::unexpected(database.error());
  // Hashes of lost records must not be taken for those of the records that follow.
  const std::string beyond = " WHERE sequence>" + std::to_string(last_sequence);
  if (auto ok = database->execute("DELETE FROM state_hashes" + beyond +
                                  ";DELETE FROM kernel_versions" + beyond);
      !ok) {
    return std::unexpected(to_journal_error(file, ok.error()));
  }
  if (auto ok = begin_writer(*database, last_sequence); !ok) {
    return std::unexpected(to_journal_error(file, ok.error()));
  }
  const auto epoch = database->integer("SELECT epoch FROM session");
  if (!epoch) return std::unexpected(to_journal_error(file, epoch.error()));
  auto groups = JournalGroups::prepare(*std::move(database));
  if (!groups) return std::unexpected(to_journal_error(file, groups.error()));
  return JournalWriter(std::make_unique<Impl>(file, *std::move(groups), last_sequence,
                                              static_cast<std::uint32_t>(*epoch)));
}

std::expected<std::uint64_t, JournalError> JournalWriter::append(ParticipantId participant,
                                                                 const RecordedCommand& command,
                                                                 RecordNote note) {
  return impl_->append(participant, std::span(&command, 1), note);
}

std::expected<std::uint64_t, JournalError> JournalWriter::append_together(
    ParticipantId participant, std::span<const RecordedCommand> commands) {
  return impl_->append(participant, commands, {});
}

void JournalWriter::keep_within(std::shared_ptr<const WriteFence> fence) {
  const std::lock_guard lock(impl_->mutex);
  impl_->fence = std::move(fence);
}

void JournalWriter::append(const JournalParticipant& participant) { impl_->push(participant); }
void JournalWriter::append(ListChange change) { impl_->push(std::move(change)); }
void JournalWriter::append(AttachmentChange change) { impl_->push(std::move(change)); }
void JournalWriter::append(StateHash state) { impl_->push(state); }
void JournalWriter::append_recarved(StateHash state) { impl_->push(RecarvedHash{state}); }

std::expected<void, JournalError> JournalWriter::flush() {
  std::unique_lock lock(impl_->mutex);
  if (impl_->closed) return std::unexpected(*impl_->obstacle());
  ++impl_->flushing;
  impl_->retry_now = impl_->failure.has_value();
  impl_->wake.notify_one();
  const std::uint64_t target = impl_->pushed;
  const std::uint64_t failed_before = impl_->figures.failed_commits;
  impl_->done.wait(lock, [&] {
    return impl_->closed || impl_->figures.failed_commits > failed_before ||
           impl_->committed >= target;
  });
  --impl_->flushing;
  if (impl_->committed >= target) return {};
  return std::unexpected(*impl_->obstacle());
}

std::expected<void, JournalError> JournalWriter::finish() {
  impl_->stop();
  const std::lock_guard lock(impl_->mutex);
  impl_->groups.reset();
  impl_->closed = true;
  impl_->done.notify_all();
  if (impl_->failure) return std::unexpected(*impl_->failure);
  return {};
}

std::uint64_t JournalWriter::last_sequence() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->last_sequence;
}
std::uint64_t JournalWriter::durable_sequence() const { return impl_->durable_sequence.load(); }
std::uint32_t JournalWriter::epoch() const { return impl_->epoch; }
bool JournalWriter::is_fenced() const { return impl_->fence && !impl_->fence->is_open(); }
std::size_t JournalWriter::lag() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->buffer.size() + impl_->in_commit;
}
std::optional<JournalError> JournalWriter::pause() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->pause();
}
void JournalWriter::hold(std::optional<JournalError> error) {
  std::unique_lock lock(impl_->mutex);
  const bool was_paused = impl_->disk_pause().has_value();
  impl_->held = std::move(error);
  impl_->report_change(was_paused, lock);
}
JournalFigures JournalWriter::figures() const {
  const std::lock_guard lock(impl_->mutex);
  JournalFigures figures = impl_->figures;
  if (impl_->in_commit > 0) {
    figures.oldest_pending_s = seconds_since(impl_->group_since);
  } else if (!impl_->buffer.empty()) {
    figures.oldest_pending_s = seconds_since(impl_->buffer_since);
  }
  return figures;
}
void JournalWriter::on_pause(std::function<void(const std::optional<JournalError>&)> report) {
  const std::lock_guard lock(impl_->mutex);
  impl_->report = std::move(report);
}
const std::filesystem::path& JournalWriter::file() const { return impl_->file; }

}  // namespace kerf
