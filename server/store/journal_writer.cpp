// SPDX-License-Identifier: Apache-2.0
#include "server/store/journal_writer.h"

#include <bit>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

namespace kerf {
namespace {

struct PendingCommand {
  std::uint64_t sequence;
  ParticipantId participant;
  std::vector<std::byte> bytes;
};
/// A hash that another version of the kernel would not compute.
struct RecarvedHash {
  StateHash state;
};
using Pending = std::variant<PendingCommand, JournalParticipant, StateHash, RecarvedHash>;

struct Inserts {
  SqlStatement command, participant, hash, version;
};

SqlResult<void> insert_version(SqlStatement& statement, std::uint64_t sequence) {
  statement.bind(1, static_cast<std::int64_t>(sequence));
  statement.bind(2, kKernelVersion);
  if (auto row = statement.step(); !row) return std::unexpected(row.error());
  return {};
}

SqlResult<void> insert(Inserts& inserts, const Pending& pending) {
  SqlStatement* statement = nullptr;
  if (const auto* command = std::get_if<PendingCommand>(&pending)) {
    statement = &inserts.command;
    statement->bind(1, static_cast<std::int64_t>(command->sequence));
    statement->bind(2, std::int64_t{command->participant});
    statement->bind(3, std::span<const std::byte>(command->bytes));
    statement->bind(
        4, std::int64_t{record_checksum(command->sequence, command->participant, command->bytes)});
  } else if (const auto* participant = std::get_if<JournalParticipant>(&pending)) {
    statement = &inserts.participant;
    statement->bind(1, std::int64_t{participant->participant});
    statement->bind(2, participant->name);
    statement->bind(3, participant->color);
    statement->bind(4, participant->kind);
  } else {
    const auto* recarved = std::get_if<RecarvedHash>(&pending);
    const StateHash state = recarved != nullptr ? recarved->state : std::get<StateHash>(pending);
    if (recarved != nullptr) {
      if (auto ok = insert_version(inserts.version, state.sequence); !ok) return ok;
    }
    statement = &inserts.hash;
    statement->bind(1, static_cast<std::int64_t>(state.sequence));
    statement->bind(2, std::bit_cast<std::int64_t>(state.hash));
  }
  if (auto row = statement->step(); !row) return std::unexpected(row.error());
  return {};
}

}  // namespace

struct JournalWriter::Impl {
  Impl(std::filesystem::path path, SqlDatabase db, Inserts statements, std::uint64_t last,
       std::uint32_t opened)
      : file(std::move(path)),
        database(std::move(db)),
        inserts(std::move(statements)),
        epoch(opened),
        last_sequence(last) {
    flusher = std::thread([this] { run(); });
  }
  ~Impl() { stop(); }

  /// Commits the pending records and joins the flusher.
  void stop() {
    {
      const std::lock_guard lock(mutex);
      stopping = true;
    }
    wake.notify_all();
    if (flusher.joinable()) flusher.join();
  }

  void push(Pending item) {
    bool was_empty = false;
    {
      const std::lock_guard lock(mutex);
      was_empty = buffer.empty();
      buffer.push_back(std::move(item));
      ++pushed;
    }
    // A flusher that collects a group wakes up by itself; only an idle one must be notified.
    if (was_empty) wake.notify_one();
  }

  void run() {
    std::unique_lock lock(mutex);
    for (;;) {
      wake.wait(lock, [&] { return stopping || !buffer.empty(); });
      if (buffer.empty()) return;
      wake.wait_for(lock, kGroupCommit, [&] { return stopping || flushing > 0; });
      std::vector<Pending> group = std::exchange(buffer, {});
      in_commit = group.size();
      lock.unlock();
      auto outcome = commit(group);
      lock.lock();
      in_commit = 0;
      committed += group.size();
      if (!outcome && !failure) failure = to_journal_error(file, outcome.error());
      done.notify_all();
    }
  }

  SqlResult<void> commit(const std::vector<Pending>& group) {
    if (auto ok = database->execute("BEGIN IMMEDIATE"); !ok) return ok;
    for (const Pending& item : group) {
      if (auto ok = insert(*inserts, item); !ok) {
        (void)database->execute("ROLLBACK");
        return ok;
      }
    }
    return database->execute("COMMIT");
  }

  std::filesystem::path file;
  std::optional<SqlDatabase> database;
  std::optional<Inserts> inserts;  // destroyed before the database
  std::uint32_t epoch;

  mutable std::mutex mutex;
  std::condition_variable wake, done;
  std::vector<Pending> buffer;
  std::size_t in_commit = 0;
  std::uint64_t pushed = 0, committed = 0;
  int flushing = 0;
  bool stopping = false;
  std::optional<JournalError> failure;
  std::uint64_t last_sequence;
  std::thread flusher;
};

JournalWriter::JournalWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
JournalWriter::JournalWriter(JournalWriter&&) noexcept = default;
JournalWriter& JournalWriter::operator=(JournalWriter&&) noexcept = default;
JournalWriter::~JournalWriter() = default;

namespace {

SqlResult<Inserts> prepare_inserts(SqlDatabase& database) {
  auto command = database.prepare("INSERT INTO commands VALUES(?,?,?,?)");
  if (!command) return std::unexpected(command.error());
  auto participant = database.prepare("INSERT OR REPLACE INTO participants VALUES(?,?,?,?)");
  if (!participant) return std::unexpected(participant.error());
  auto hash = database.prepare("INSERT OR REPLACE INTO state_hashes VALUES(?,?)");
  if (!hash) return std::unexpected(hash.error());
  auto version = database.prepare("INSERT OR REPLACE INTO kernel_versions VALUES(?,?)");
  if (!version) return std::unexpected(version.error());
  return Inserts{*std::move(command), *std::move(participant), *std::move(hash),
                 *std::move(version)};
}

}  // namespace

std::expected<JournalWriter, JournalError> JournalWriter::create(const std::filesystem::path& file,
                                                                 const JournalHeader& header) {
  auto database = create_journal(file, header);
  if (!database) return std::unexpected(database.error());
  auto inserts = prepare_inserts(*database);
  if (!inserts) return std::unexpected(to_journal_error(file, inserts.error()));
  return JournalWriter(
      std::make_unique<Impl>(file, *std::move(database), *std::move(inserts), 0, 1));
}

std::expected<JournalWriter, JournalError> JournalWriter::open(const std::filesystem::path& file,
                                                               std::uint64_t last_sequence) {
  auto database = open_journal(file, SqlMode::kWrite);
  if (!database) return std::unexpected(database.error());
  auto inserts = prepare_inserts(*database);
  if (!inserts) return std::unexpected(to_journal_error(file, inserts.error()));
  const auto epoch = database->integer("SELECT epoch FROM session");
  if (!epoch) return std::unexpected(to_journal_error(file, epoch.error()));
  return JournalWriter(std::make_unique<Impl>(file, *std::move(database), *std::move(inserts),
                                              last_sequence, static_cast<std::uint32_t>(*epoch)));
}

std::expected<std::uint64_t, JournalError> JournalWriter::append(ParticipantId participant,
                                                                 const Command& command) {
  std::uint64_t sequence = 0;
  {
    const std::lock_guard lock(impl_->mutex);
    if (impl_->failure) return std::unexpected(*impl_->failure);
    if (impl_->buffer.size() + impl_->in_commit >= kJournalBufferRecords) {
      return std::unexpected(
          JournalError{JournalErrorCode::kFull, impl_->file.string(), 0,
                       "the disk does not keep up: " + std::to_string(kJournalBufferRecords) +
                           " records are pending"});
    }
    sequence = ++impl_->last_sequence;
  }
  impl_->push(PendingCommand{sequence, participant, encode_command(command)});
  return sequence;
}

void JournalWriter::append(const JournalParticipant& participant) { impl_->push(participant); }
void JournalWriter::append(StateHash state) { impl_->push(state); }
void JournalWriter::append_recarved(StateHash state) { impl_->push(RecarvedHash{state}); }

std::expected<void, JournalError> JournalWriter::flush() {
  std::unique_lock lock(impl_->mutex);
  ++impl_->flushing;
  impl_->wake.notify_one();
  const std::uint64_t target = impl_->pushed;
  impl_->done.wait(lock, [&] { return impl_->failure || impl_->committed >= target; });
  --impl_->flushing;
  if (impl_->failure) return std::unexpected(*impl_->failure);
  return {};
}

std::expected<void, JournalError> JournalWriter::finish() {
  impl_->stop();
  const std::lock_guard lock(impl_->mutex);
  impl_->inserts.reset();
  impl_->database.reset();
  const std::optional<JournalError> failure = impl_->failure;
  if (!failure) {
    impl_->failure =
        JournalError{JournalErrorCode::kIo, impl_->file.string(), 0, "the journal is closed"};
  }
  impl_->done.notify_all();
  if (failure) return std::unexpected(*failure);
  return {};
}

std::uint64_t JournalWriter::last_sequence() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->last_sequence;
}
std::uint32_t JournalWriter::epoch() const { return impl_->epoch; }
std::size_t JournalWriter::lag() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->buffer.size() + impl_->in_commit;
}
const std::filesystem::path& JournalWriter::file() const { return impl_->file; }

}  // namespace kerf
