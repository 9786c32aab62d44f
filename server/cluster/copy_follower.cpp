// SPDX-License-Identifier: Apache-2.0
#include "server/cluster/copy_follower.h"

#include <chrono>
#include <condition_variable>
#include <span>
#include <utility>
#include <vector>

#include "server/cluster/snapshot_copy.h"
#include "server/cluster/takeover.h"
#include "server/history/journal_records.h"
#include "server/log/log.h"
#include "server/platform/clock.h"
#include "server/session/live_state.h"
#include "server/store/journal_change.h"
#include "server/threads/run_and_wait.h"

namespace kerf {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kFollowTick{100};
/// Minimum interval between comparisons of state hashes, because the owner's are read from the
/// journal.
constexpr std::chrono::seconds kCompare{2};
/// Minimum interval, while no message comes, between checks that NATS still has the last one.
constexpr std::chrono::seconds kLookBack{1};

}  // namespace

std::string live_subject(const std::string& session) { return "kerf.live." + session; }

/// State of a followed session.
struct CopyFollower::Followed {
  std::shared_ptr<Session> session;
  std::filesystem::path file;
  JournalCopy copy;
  std::unique_ptr<RecordSource> records;
  FrameJoiner joiner = {};
  std::uint64_t applied = 0;   ///< last record
  std::uint64_t compared = 0;  ///< record of the owner's hash compared last
  Clock::time_point compared_at = {}, looked_back_at = {};
};

CopyFollower::CopyFollower(NatsConnection& nats, SessionRegistry& registry, std::string session,
                           std::string node)
    : nats_(nats),
      registry_(registry),
      id_(std::move(session)),
      node_(std::move(node)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

CopyFollower::~CopyFollower() = default;

void CopyFollower::run(const std::stop_token& stop) {
  const auto followed = follow(stop);
  if (followed || stop.stop_requested()) return;
  log::error("session " + id_ + " cannot be followed: " + followed.error());
  registry_.end_following(id_, "the server cannot follow the session any more");
  state_ = State::kFailed;
}

std::expected<void, std::string> CopyFollower::follow(const std::stop_token& stop) {
  const auto file = registry_.journal_path(id_);
  const auto begun = prepare_following(nats_, id_, file, registry_.closed_folder());
  if (!begun) return std::unexpected(begun.error());
  message_ = begun->message;
  if (const auto got = fetch_snapshots(nats_, id_, kAnyEpoch, file); !got) {
    log::warn("session " + id_ + ": a snapshot of its copy cannot be used: " + got.error());
  }
  if (stop.stop_requested()) return {};
  const auto session = registry_.follow(id_);
  if (!session) return std::unexpected(describe(session.error()));
  auto copy = JournalCopy::resume(file, begun->position);
  if (!copy) return std::unexpected(describe(copy.error()));
  Followed followed{*session, file, *std::move(copy), journal_records(file)};
  followed.applied = (*session)->sequence();
  const NatsListener live = hear_live(*session);
  state_ = State::kFollows;
  log::info("session " + id_ + ": followed from record " + std::to_string(followed.applied));
  std::mutex mutex;
  std::condition_variable_any wake;
  std::unique_lock lock(mutex);
  while (!stop.stop_requested()) {
    if (auto ok = take_messages(followed, stop); !ok) return ok;
    wake.wait_for(lock, stop, kFollowTick, [] { return false; });
  }
  return {};
}

/// Receives messages until NATS is away. An error ends the following.
std::expected<void, std::string> CopyFollower::take_messages(Followed& followed,
                                                             const std::stop_token& stop) {
  auto watch = nats_.watch_from(copy_stream(id_), copy_subject(id_), message_ + 1);
  if (!watch && watch.error().code == NatsErrorCode::kAbsent) {
    return std::unexpected("its copy was deleted");
  }
  if (!watch) return {};
  while (!stop.stop_requested() && !followed.session->closed()) {
    const auto message = watch->next(kFollowTick);
    if (!message) return {};
    if (auto ok = *message ? take(followed, **message) : look_back(followed); !ok) return ok;
    if (*message) message_ = (*message)->sequence;
  }
  return {};
}

/// Called while no message comes. NATS may have come back with fewer messages than this server has
/// seen. New messages then reuse numbers, and the watch skips them.
std::expected<void, std::string> CopyFollower::look_back(Followed& followed) {
  const auto now = Clock::now();
  if (now >= followed.looked_back_at + kLookBack) {
    followed.looked_back_at = now;
    const auto last = nats_.last_message(copy_stream(id_), copy_subject(id_));
    const std::uint64_t newest = last && *last ? (*last)->sequence : 0;
    if (last && newest < message_) {
      return std::unexpected("NATS has lost messages: " + std::to_string(message_) +
                             " of its copy was seen, the last one now is " +
                             std::to_string(newest));
    }
  }
  return compare(followed);
}

std::expected<void, std::string> CopyFollower::take(Followed& followed,
                                                    const StreamMessage& message) {
  const auto change = followed.joiner.add(message.bytes);
  if (!change) {
    return std::unexpected("message " + std::to_string(message.sequence) + ": " + change.error());
  }
  if (!*change) return {};
  if (auto ok = followed.copy.apply(**change); !ok) return std::unexpected(describe(ok.error()));
  if (!(*change)->is_whole) return {};
  if (auto ok = deliver(followed); !ok) return ok;
  if (followed.copy.take_changed_attachments()) {
    if (auto ok = registry_.note_attachments(*followed.session); !ok) return ok;
  }
  if (followed.copy.take_changed_lists()) return deliver_lists(followed);
  return compare(followed);
}

/// Applies the new records of the journal.
std::expected<void, std::string> CopyFollower::deliver(Followed& followed) {
  const std::uint64_t last = followed.copy.whole()->record;
  if (last <= followed.applied) return {};
  std::vector<JournalRecord> records;
  const RecordRange range{followed.applied + 1, last};
  const auto keep = [&](JournalRecord& record) { records.push_back(std::move(record)); };
  if (auto read = followed.records->read({&range, 1}, keep, {}); !read) return read;
  std::span<const JournalRecord> rest(records);
  while (!rest.empty()) {
    const auto done =
        run_and_wait(followed.session->executor(), [&] { return followed.session->follow(rest); });
    if (!done) return std::unexpected(done.error());
    if (*done == 0) return {};  // it was closed
    rest = rest.subspan(*done);
  }
  followed.applied = last;
  return {};
}

std::expected<void, std::string> CopyFollower::deliver_lists(Followed& followed) {
  auto reader = JournalReader::open(followed.file, RecordOrder::kSequence, {}, followed.applied);
  if (!reader) return std::unexpected(describe(reader.error()));
  run_and_wait(followed.session->executor(), [&] {
    followed.session->matters().restore(reader->lists());
    return 0;
  });
  return {};
}

/// A different block is a fault of this machine, or of its memory.
std::expected<void, std::string> CopyFollower::compare(Followed& followed) {
  const auto now = Clock::now();
  const std::uint64_t newest = followed.copy.whole()->hash_after;
  if (newest == followed.compared || now < followed.compared_at + kCompare) return {};
  followed.compared_at = now;
  const auto reader =
      JournalReader::open(followed.file, RecordOrder::kSequence, {}, followed.applied);
  if (!reader) return std::unexpected(describe(reader.error()));
  if (reader->state_hashes().empty()) return {};
  const StateHash owners = reader->state_hashes().back();
  const auto is_equal = run_and_wait(followed.session->executor(),
                                     [&] { return followed.session->compare_hash(owners); });
  if (!is_equal) return std::unexpected(is_equal.error());
  if (*is_equal) followed.compared = newest;
  return {};
}

NatsListener CopyFollower::hear_live(const std::shared_ptr<Session>& session) const {
  const auto take = [weak = std::weak_ptr(session), node = node_](const StreamMessage& message) {
    const auto followed = weak.lock();
    auto state = decode_live(message.bytes);
    if (!followed || !state) return;
    std::size_t elsewhere = 0;
    for (const auto& [name, viewers] : state->viewers) elsewhere += name == node ? 0 : viewers;
    followed->executor().post([followed, state = *std::move(state), elsewhere]() mutable {
      followed->follow_live(std::move(state), elsewhere);
    });
  };
  auto listener = nats_.listen(live_subject(id_), take);
  if (listener) return *std::move(listener);
  log::warn("session " + id_ + ": its participants are not shown here: " + listener.error().reason);
  return NatsListener();
}

bool CopyFollower::finish(milliseconds wait) {
  const auto end = Clock::now() + wait;
  bool has_all = false;
  while (!has_all && state_ == State::kFollows && Clock::now() < end) {
    const auto last = end_of_copy(nats_, id_);
    has_all = last && *last && message_ >= (*last)->sequence;
    if (!last || !*last) break;
    if (!has_all) std::this_thread::sleep_for(milliseconds(5));
  }
  thread_.request_stop();
  thread_.join();
  return has_all && state_ == State::kFollows;
}

}  // namespace kerf
