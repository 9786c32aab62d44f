// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/takeover.h"

#include <utility>

#include "server/cluster/change_frame.h"
#include "server/cluster/copies.h"
#include "server/log/log.h"
#include "server/platform/clock.h"
#include "server/platform/random.h"
#include "server/store/journal_change.h"
#include "server/store/journal_file.h"

namespace kerf {
namespace {

/// Messages that a former owner may add before this is an error.
constexpr int kMarkAttempts = 100;

/// Adds a change without rows after the last message of the copy, if that is `end`, which tells
/// writers before `epoch` that they were succeeded. Returns false if it is not.
std::expected<bool, std::string> add_mark(NatsConnection& nats, const std::string& session,
                                          std::uint32_t epoch, std::uint64_t end,
                                          const CopyPosition& position, bool is_whole) {
  const std::uint64_t writer = random_number();
  // The mark has the epoch before, because the new journal replica has `epoch`.
  const FrameHead head{.epoch = epoch - 1,
                       .writer = writer,
                       .change = 1,
                       .part = 0,
                       .parts = 1,
                       .is_whole = is_whole,
                       .before = position,
                       .after = position};
  const std::string id = session + "/" + std::to_string(writer);
  const auto stored = nats.publish(copy_subject(session), encode_frame(head, {}), id, end);
  if (stored) return true;
  if (stored.error().code == NatsErrorCode::kNotNext) return false;
  return std::unexpected(stored.error().reason);
}

/// Ends the epochs before `epoch` in the copy, and returns its end, or nullopt without a copy.
std::expected<std::optional<CopyEnd>, std::string> end_epochs(NatsConnection& nats,
                                                              const std::string& session,
                                                              std::uint32_t epoch) {
  for (int n = 0; n < kMarkAttempts; ++n) {
    auto end = end_of_copy(nats, session);
    if (!end || !*end) return end;
    if ((*end)->head.epoch >= epoch) {
      return std::unexpected("its copy is of epoch " + std::to_string((*end)->head.epoch) +
                             ", and this server would run it in epoch " + std::to_string(epoch));
    }
    const auto added =
        add_mark(nats, session, epoch, (*end)->sequence, (*end)->head.position(), false);
    if (!added) return std::unexpected(added.error());
    if (*added) return end;
  }
  return std::unexpected("another server adds to its copy all the time");
}

/// Removes an old journal, for good if the fetched one has all of it.
std::expected<void, std::string> put_away(const std::filesystem::path& file,
                                          const std::filesystem::path& fetched,
                                          const std::string& session,
                                          const std::filesystem::path& kept) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return {};
  const auto end = end_of_journal(file);
  const auto has_all = end ? JournalChanges(fetched).begin(*end) : std::unexpected(end.error());
  if (has_all && *has_all) {
    remove_journal(file);
    return {};
  }
  std::filesystem::create_directories(kept, error);
  const auto moved = keep_journal(file, kept, session + "-" + std::to_string(Clock::wall_s()));
  if (!moved) return std::unexpected(file.string() + ": " + moved.error().message());
  log::warn("session " + session +
            ": the journal of this server has records that were not copied " +
            "before another one continued; it is kept as " + moved->string());
  return {};
}

std::filesystem::path fetched_file(const std::filesystem::path& file) {
  return file.string() + "-fetched";
}

std::expected<FetchedCopy, std::string> fetch_beside(NatsConnection& nats,
                                                     const std::string& session,
                                                     const std::filesystem::path& file) {
  remove_journal(fetched_file(file));
  return fetch_copy(nats, session, fetched_file(file));
}

/// Whether a journal can be used instead of the copy that ends so.
bool can_continue(const std::filesystem::path& file, const FrameHead& end, bool is_current) {
  const CopyPosition position = end.position();
  const auto continues = JournalChanges(file).begin(position);
  if (!continues || !*continues) return false;
  if (is_current) return true;
  const auto here = end_of_journal(file);
  if (here && here->record > position.record) return true;
  // Rights, pins and other data may have changed in a later epoch without a record.
  const auto epoch = epoch_written(file);
  return epoch && *epoch >= end.epoch;
}

/// Replaces the session's journal by the fetched copy.
std::expected<void, std::string> put_in_place(const std::filesystem::path& file,
                                              const std::string& session,
                                              const std::filesystem::path& kept) {
  if (auto ok = put_away(file, fetched_file(file), session, kept); !ok) return ok;
  const std::filesystem::path mark = file.string() + kCopiedSuffix;
  std::error_code failed;
  std::filesystem::rename(fetched_file(file).string() + kCopiedSuffix, mark, failed);
  if (!failed) failed = rename_new(fetched_file(file), file);
  if (failed) return std::unexpected(file.string() + ": " + failed.message());
  return {};
}

}  // namespace

std::expected<std::uint32_t, std::string> epoch_of_copy(NatsConnection& nats,
                                                        const std::string& session) {
  const auto end = end_of_copy(nats, session);
  if (!end) return std::unexpected(end.error());
  return *end ? (*end)->head.epoch : 0;
}

std::expected<void, std::string> prepare_journal(NatsConnection& nats, const std::string& session,
                                                 std::uint32_t epoch,
                                                 const std::filesystem::path& file,
                                                 const std::filesystem::path& kept,
                                                 bool is_current) {
  const auto end = end_epochs(nats, session, epoch);
  if (!end) return std::unexpected(end.error());
  std::error_code error;
  const bool is_here = std::filesystem::exists(file, error);
  if (!*end && is_here) return {};
  if (!*end) return std::unexpected("there is neither a copy nor a journal of it here");
  const CopyPosition position = (*end)->head.position();
  if (is_here && can_continue(file, (*end)->head, is_current)) return {};
  const auto got = fetch_beside(nats, session, file);
  if (!got) return std::unexpected(got.error());
  if (got->position != position) {
    // The copy ends within a commit: changes after the last whole one are dropped.
    const auto now = end_of_copy(nats, session);
    if (!now || !*now) return std::unexpected("the copy has gone");
    const auto added = add_mark(nats, session, epoch, (*now)->sequence, got->position, true);
    if (!added) return std::unexpected(added.error());
    if (!*added) return std::unexpected("another server adds to its copy");
  }
  return put_in_place(file, session, kept);
}

std::expected<FetchedCopy, std::string> prepare_following(NatsConnection& nats,
                                                          const std::string& session,
                                                          const std::filesystem::path& file,
                                                          const std::filesystem::path& kept) {
  const auto end = end_of_copy(nats, session);
  if (!end) return std::unexpected(end.error());
  if (!*end) return std::unexpected("there is no copy of it");
  const FrameHead& head = (*end)->head;
  const auto here = end_of_journal(file);
  const auto epoch = epoch_written(file);
  if (here && head.is_last() && head.is_whole && *here == head.position() && epoch &&
      *epoch >= head.epoch) {
    return FetchedCopy{head.position(), (*end)->sequence};
  }
  const auto got = fetch_beside(nats, session, file);
  if (!got) return std::unexpected(got.error());
  if (auto ok = put_in_place(file, session, kept); !ok) return std::unexpected(ok.error());
  return *got;
}

}  // namespace kerf
