// SPDX-License-Identifier: Apache-2.0
#include "server/session/stroke_changes.h"

#include <algorithm>
#include <new>
#include <thread>
#include <utility>

#include "kernel/cut/workers.h"
#include "server/history/block_history.h"
#include "server/platform/clock.h"
#include "server/rights/rights.h"
#include "server/threads/run_and_wait.h"

namespace kerf {
namespace {

/// Time on the session's thread of one turn of replacing tiles, and the pause before tiles are
/// carved again after the journal could not be read.
constexpr std::chrono::microseconds kReplaceTurn{1000};
constexpr std::chrono::seconds kRetry{1};
/// Interval between two looks whether a change is copied.
constexpr std::chrono::milliseconds kCopyLook{5};
/// Motions cut again in one turn, and the number of rounds that try to reduce them to this.
constexpr std::size_t kSinceMax = 100;
constexpr int kRoundsMax = 4;

Rejection no_stroke(const std::string& reason) { return {wire::ErrorCode::kBadMessage, reason}; }

StrokeSet strokes_of(const std::map<StrokeId, std::uint64_t>& changes) {
  StrokeSet strokes;
  for (const auto& [stroke, record] : changes) strokes.insert(strokes.end(), stroke);
  return strokes;
}

/// Returns the strokes of a request made after record `at`. They must exist and not be in that
/// state.
std::expected<StrokeSet, Rejection> chosen_strokes(const BlockHistory& history,
                                                   const StrokeRequest& request, std::uint64_t at) {
  const StrokeTable& table = history.strokes();
  const StrokeSet undone = table.at(history.last()).without;
  StrokeSet strokes(request.strokes.begin(), request.strokes.end());
  if (strokes.empty()) {
    const StrokeId newest = request.undone ? table.newest(request.participant, at)
                                           : table.last_undone(request.participant, at);
    if (newest == 0) {
      return std::unexpected(no_stroke("participant " + std::to_string(request.participant) +
                                       " has no stroke to " + (request.undone ? "undo" : "redo")));
    }
    strokes.insert(newest);
  }
  for (const StrokeId id : strokes) {
    if (table.find(id) == nullptr) {
      return std::unexpected(no_stroke("no stroke begins with record " + std::to_string(id)));
    }
    if (undone.contains(id) == request.undone) {
      return std::unexpected(no_stroke("stroke " + std::to_string(id) +
                                       (request.undone ? " is" : " is not") + " undone"));
    }
  }
  return strokes;
}

/// Ends the collection of motions on every exit.
class Collecting {
 public:
  Collecting(Executor& executor, Carving& carving) : executor_(executor), carving_(carving) {}
  Collecting(const Collecting&) = delete;
  Collecting& operator=(const Collecting&) = delete;
  ~Collecting() {
    run_and_wait(executor_, [this] {
      carving_.end_collecting();
      return true;
    });
  }

 private:
  Executor& executor_;
  Carving& carving_;
};

}  // namespace

StrokeChanges::StrokeChanges(const Parts& parts, Executor& background, SessionOwner owner,
                             std::function<void()> settled)
    : executor_(parts.executor),
      sculpture_(parts.sculpture),
      journal_(parts.journal),
      past_(parts.past),
      participants_(parts.participants),
      carving_(parts.carving),
      background_(&background),
      owner_(std::move(owner)),
      settled_(std::move(settled)) {}

/// Whether the author may change a stroke of a participant: its own, or any as an owner.
bool StrokeChanges::may_change(const StrokeRequest& request, ParticipantId participant) {
  const ParticipantState* author = participants_.find(request.author);
  const Role role = author != nullptr ? author->participant.role : request.caller.role;
  if (may(role, Action::kModerate)) return true;
  if (!may(role, Action::kUndo)) return false;
  if (request.author != 0) return request.author == participant;
  const ParticipantState* state = participants_.find(participant);
  const std::string person = state == nullptr ? "" : state->person;
  return request.caller.is_personal && request.caller.grant == person;
}

/// Journals the changes. From then on the block is wrong until settle() has replaced its tiles.
std::optional<Rejection> StrokeChanges::note(const StrokeRequest& request,
                                             std::span<const Stroke> all) {
  using enum wire::ErrorCode;
  if (closed_) return Rejection{kUnknownSession, "the session is closed"};
  const ParticipantState* author = participants_.find(request.author);
  if (author != nullptr ? author->participant.is_muted : request.caller.is_muted) {
    return muted_rejection();
  }
  for (const Stroke& stroke : all) {
    if (may_change(request, stroke.participant)) continue;
    return Rejection{kNotAllowed, "stroke " + std::to_string(stroke.id) + " is participant " +
                                      std::to_string(stroke.participant) +
                                      "'s: an owner may change those of others"};
  }
  if (auto ok = journal_.check_space_for_programs(); !ok) return ok.error();
  std::vector<RecordedCommand> changes;
  auto unsettled = unsettled_;
  std::uint64_t record = journal_.sequence();
  for (const Stroke& stroke : all) {
    changes.emplace_back(StrokeChange{stroke.id, request.undone});
    unsettled[stroke.id] = ++record;
  }
  participants_.end_strokes();
  if (auto ok = journal_.append(request.author, changes); !ok) return ok.error();
  // Nothing may fail after the journaling.
  unsettled_ = std::move(unsettled);
  journal_.note_removal();
  return std::nullopt;
}

std::expected<StrokesChanged, Rejection> StrokeChanges::change(const StrokeRequest& request,
                                                               Workers& workers,
                                                               const std::stop_token& stop) try {
  const std::uint64_t at =
      request.at ? *request.at : run_and_wait(executor_, [this] { return journal_.sequence(); });
  const SessionPast::Turn turn = past_.ask();
  const auto history = turn ? past_.read(stop) : std::unexpected(std::string(kOthersAskHistory));
  if (!history) {
    const auto damage = past_.damage_after(history.error(), stop);
    return std::unexpected(damage
                               ? Rejection{wire::ErrorCode::kDamagedJournal, damage_text(*damage)}
                               : Rejection{wire::ErrorCode::kBusy, history.error()});
  }
  const auto chosen = chosen_strokes(**history, request, at);
  if (!chosen) return std::unexpected(chosen.error());
  std::vector<Stroke> strokes;
  for (const StrokeId id : *chosen) strokes.push_back(*(*history)->strokes().find(id));
  StrokesChanged changed{.strokes = {chosen->begin(), chosen->end()}};
  const auto rejected = run_and_wait(executor_, [&] {
    auto fault = note(request, strokes);
    changed.sequence = journal_.sequence();
    return fault;
  });
  if (rejected) return std::unexpected(*rejected);
  if (auto settled = try_to_settle(workers, stop, changed); !settled) {
    changed.pending = settled.error();
    retry_settling();
  }
  return changed;
} catch (const std::bad_alloc&) {  // before anything was journaled
  return std::unexpected(Rejection{wire::ErrorCode::kBusy,
                                   "the server has not enough memory for this now; try later"});
}

/// Like settle(). If memory runs out, the changes stay pending.
std::expected<void, std::string> StrokeChanges::try_to_settle(Workers& workers,
                                                              const std::stop_token& stop,
                                                              StrokesChanged& changed) {
  try {
    return settle(workers, stop, changed);
  } catch (const std::bad_alloc&) {
    past_.discard();
    return std::unexpected("the server has not enough memory for the change now; it tries again");
  }
}

void StrokeChanges::change_later(StrokeRequest request, Done done) {
  request.at = journal_.sequence();
  background_->post(
      [this, session = owner_.hold(), request = std::move(request), done = std::move(done)] {
        SerialWorkers alone;
        auto changed = change(request, alone);
        const auto flushed = journal_.flush();
        if (changed && !flushed && !changed->pending) changed->pending = describe(flushed.error());
        executor_.post([this, session, changed = std::move(changed), done]() mutable {
          if (!changed || changed->pending) return done(changed);
          answer_when_durable(*std::move(changed), Clock::now() + kCopyPatience, std::move(done));
        });
      });
}

/// Holds no thread meanwhile: the background thread is shared by all sessions.
void StrokeChanges::answer_when_durable(StrokesChanged changed, Clock::time_point end, Done done) {
  const bool is_durable = journal_.durable_sequence() >= changed.sequence;
  if (!is_durable && !closed_ && Clock::now() < end) {
    auto again = [this, watched = owner_.watch(), changed = std::move(changed), end,
                  done = std::move(done)]() mutable {
      const auto session = watched.lock();
      if (session) answer_when_durable(std::move(changed), end, std::move(done));
    };
    return executor_.post_after(kCopyLook, std::move(again));
  }
  if (!is_durable) changed.pending = describe(journal_.not_copied());
  done(changed);
}

/// Waits until no motion journaled so far is partly cut: pieces of an undone motion must not be cut
/// from the new tiles.
std::expected<void, std::string> StrokeChanges::wait_for_pieces(const std::stop_token& stop) {
  constexpr std::chrono::milliseconds kPause{1};
  const std::uint64_t until = run_and_wait(executor_, [this] { return journal_.sequence(); });
  while (run_and_wait(executor_, [&] { return !closed_ && carving_.is_cutting(until); })) {
    if (stop.stop_requested()) return std::unexpected("stopped");
    std::this_thread::sleep_for(kPause);
  }
  return {};
}

/// Carves the tiles of changed strokes and replaces them in the block, some at a time to bound the
/// memory. Call with the lock held.
std::expected<void, std::string> StrokeChanges::settle(Workers& workers,
                                                       const std::stop_token& stop,
                                                       StrokesChanged& changed) {
  StrokeSet strokes;
  const std::uint64_t at = run_and_wait(executor_, [&] {
    strokes = strokes_of(unsettled_);
    return journal_.sequence();
  });
  const auto history = past_.read(stop);
  if (!history) return std::unexpected(history.error());
  const auto reached = (*history)->reach(strokes, stop);
  if (!reached) return std::unexpected(reached.error());
  for (std::span<const FieldTile> left(*reached); !left.empty();) {
    const auto some = left.first(std::min(kTilesAtOnce, left.size()));
    left = left.subspan(some.size());
    if (auto ok = settle_tiles(some, workers, stop, changed); !ok) return ok;
  }
  run_and_wait(executor_, [&] {
    // A stroke that has changed again since is not settled.
    std::erase_if(unsettled_, [&](const auto& stroke) { return stroke.second <= at; });
    participants_.hold_tools_in_stock();
    journal_.note_removal();
    settled_();
    return true;
  });
  return {};
}

/// Carves these tiles and replaces them. Motions that arrive meanwhile are cut again.
std::expected<void, std::string> StrokeChanges::settle_tiles(std::span<const FieldTile> some,
                                                             Workers& workers,
                                                             const std::stop_token& stop,
                                                             StrokesChanged& changed) {
  struct Begun {
    StrokeSet strokes = {};
    std::uint64_t sequence = 0;
    SolidSnapshot solid = {};
  };
  if (auto ok = wait_for_pieces(stop); !ok) return ok;
  const Collecting collecting(executor_, carving_);
  const auto carve = [&]() -> std::expected<std::vector<TileReplacement>, std::string> {
    const Begun begun = run_and_wait(executor_, [this] {
      carving_.begin_collecting();
      return Begun{strokes_of(unsettled_), journal_.sequence(), sculpture_.solid()};
    });
    const auto history = past_.read(stop);
    if (!history) return std::unexpected(history.error());
    const MotionSet set = (*history)->strokes().at(begun.sequence);
    return (*history)->change(begun.solid, some, begun.strokes, set, workers, stop);
  };
  auto tiles = carve();
  // Each round takes less time than the last, so fewer motions arrive during it.
  const auto collected = [this] { return carving_.collected(); };
  for (int n = 1; n < kRoundsMax && tiles && run_and_wait(executor_, collected) > kSinceMax; ++n) {
    tiles = carve();
  }
  if (!tiles) return std::unexpected(tiles.error());
  changed.tiles += tiles->size();
  for (std::size_t next = 0; next < tiles->size();) {
    run_and_wait(executor_, [&] {
      const auto end = Clock::now() + kReplaceTurn;
      for (; next < tiles->size() && !closed_ && Clock::now() < end; ++next) {
        changed.returned_mm3 += carving_.replace((*tiles)[next]);
        (*tiles)[next].tile.reset();  // now shared with the block
      }
      if (closed_) next = tiles->size();
      return next;
    });
  }
  return {};
}

/// Retries carving the tiles of changed strokes until it succeeds or the session is closed.
void StrokeChanges::retry_settling() {
  executor_.post_after(kRetry, [this, watched = owner_.watch()] {
    const auto session = watched.lock();
    if (session && !closed_ && !unsettled_.empty()) settle_later();
  });
}

/// Re-carves changed strokes on the background thread.
void StrokeChanges::settle_later() {
  background_->post([this, session = owner_.hold()] {
    const SessionPast::Turn turn = past_.ask();
    SerialWorkers alone;
    StrokesChanged ignored;
    if (!turn || !try_to_settle(alone, {}, ignored)) retry_settling();
  });
}

/// From now on the block is wrong until the stroke's tiles have been carved again.
void StrokeChanges::follow(const StrokeChange& change) {
  unsettled_[change.stroke] = journal_.sequence();
  journal_.note_removal();
  settle_later();
}

}  // namespace kerf
