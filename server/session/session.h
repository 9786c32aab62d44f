// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <expected>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "server/convert/rejection.h"
#include "server/convert/tool_track.h"
#include "server/feed/stock_feed.h"
#include "server/formats/scene.h"
#include "server/session/participant.h"
#include "server/session/program_runs.h"
#include "server/session/rate_limit.h"
#include "server/session/replay.h"
#include "server/store/journal_writer.h"
#include "server/threads/executor.h"
#include "server/wire/types.h"

namespace kerf {

/// What one session admits. Every limit answers with a typed rejection to the peer that hits it.
struct SessionLimits {
  std::size_t agents_max = 32;
  std::size_t viewers_max = 2000;
  std::size_t programs_max = 16;  ///< running at once
  double samples_per_s =
      1250;  ///< of one agent, on average: 1 kHz and a clock that runs a little fast
  double samples_burst = 1000;       ///< one second of a network that stood still
  double speed_mm_per_s = 5000;      ///< of a cutting tip
  std::int64_t tiles_max = 1 << 20;  ///< of a block: viewers are sent every one of them
};

/// The answer to a batch of samples: what to send back to that agent, and nobody else.
struct MotionAnswer {
  wire::Result result;
  std::vector<Rejection> rejections;    ///< at most one per sample
  std::optional<wire::ToolState> felt;  ///< of the participant whom this one feels, if it is there
};

/// Somebody came, went or changed tool (`closing` empty), or the session ends (`closing` says why).
struct SessionEvent {
  std::string closing;
};
using SessionListener = std::function<void(const SessionEvent&)>;

/// What viewers need of the block, gathered in one visit to the executor.
struct SessionFrame {
  std::uint64_t sequence = 0;  ///< of the last record applied
  std::uint64_t motions = 0;
  double removed_mm3 = 0;
  wire::ToolStates tools;
  std::vector<TileIndex> changed;         ///< since the frame before; sorted
  std::optional<SolidSnapshot> snapshot;  ///< present if anything changed, or if asked for
  std::uint64_t changed_sequence = 0;     ///< of the last record that took anything away
  std::optional<StateHash> hash;          ///< the newest one known
  bool hash_is_current = false;           ///< it is that of the solid as it is now
};

struct SessionInfo {
  std::string id;
  std::uint64_t sequence = 0, motions = 0, sub_motions = 0;
  double stock_mm3 = 0, removed_mm3 = 0;
  std::size_t journal_lag = 0;
  std::uint32_t epoch = 1;
  std::vector<Participant> participants;
};

/// One block and the people at it. Everything below the line "executor only" must be called on the
/// session's executor, which is therefore the one place where the order of motions is decided.
/// `workers` computes state hashes.
class Session : public std::enable_shared_from_this<Session> {
 public:
  /// Takes over a replayed (or new) block and its journal. `workers` must outlive the session.
  Session(std::string id, Replayed replayed, JournalWriter journal, SessionLimits limits,
          std::shared_ptr<Executor> executor, Executor& workers);

  const std::string& id() const { return id_; }
  const Scene& scene() const { return scene_; }
  std::uint32_t epoch() const { return journal_.epoch(); }
  const std::filesystem::path& journal_file() const { return journal_.file(); }
  Executor& executor() { return *executor_; }
  const DexelGrid& grid() const { return sculpture_.grid(); }
  /// Blocks until everything applied so far is in the journal file (any thread).
  std::expected<void, JournalError> flush() { return journal_.flush(); }
  /// Commits and closes the journal of a session that was closed before (any thread, once).
  std::expected<void, JournalError> finish_journal() { return journal_.finish(); }
  /// Records waiting for the disk (any thread).
  std::size_t journal_lag() const { return journal_.lag(); }
  /// Motions applied since the server started (any thread).
  std::uint64_t motions_applied() const { return motions_applied_.load(std::memory_order_relaxed); }

  // ---- executor only ----
  std::expected<Participant, Rejection> join(const JoinRequest& request);
  void leave(ParticipantId id);
  std::expected<void, Rejection> choose_tool(ParticipantId id, ToolId tool);
  /// Validates, journals and applies each sample in turn; a rejected one changes nothing and does
  /// not stop the others.
  MotionAnswer move(ParticipantId id, std::span<const wire::MotionSample> samples);

  /// For a participant that keeps a copy of the block near its tool: what it lacks, if anything.
  std::optional<StockUpdate> stock_update(ParticipantId id);
  /// It has every patch up to this one. Rejects a patch that was never sent, and whoever is sent
  /// none.
  std::expected<void, Rejection> ack_stock(ParticipantId id, std::uint64_t sequence);
  /// Its copy is wrong: the next patch begins a new one. Nothing for whoever keeps none.
  void reset_stock(ParticipantId id);

  /// Carves a program as one more participant.
  std::expected<ProgramStatus, Rejection> start_program(Program program, ProgramPace pace);
  std::optional<ProgramStatus> program(ProgramId id) const { return programs_.status(id); }
  std::vector<ProgramStatus> programs() const { return programs_.list(); }
  bool cancel_program(ProgramId id);

  SessionInfo info() const;
  std::vector<Participant> participants() const;
  SessionFrame frame(bool with_snapshot);
  SolidSnapshot snapshot() { return sculpture_.solid(); }
  SolidSnapshot solid() { return sculpture_.solid(); }
  std::uint64_t sequence() const { return journal_.last_sequence(); }
  /// The hash of the solid as it is now, if it is known; its sequence is sequence().
  std::optional<StateHash> current_hash() const;
  /// Remembers and journals a hash that somebody computed from a snapshot of `state.sequence`.
  void note_hash(StateHash state);

  /// Calls `listener` on the executor at each event until unlisten.
  int listen(SessionListener listener);
  void unlisten(int listener);
  /// Ends it: tells the listeners, stops the programs. Nothing is applied afterwards.
  void close(const std::string& reason);
  bool closed() const { return closed_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Seat {
    Participant who;
    bool feel = true;
    ParticipantId feel_of = 0;
    ToolTrack track;
    std::uint64_t last_sequence = 0;
    std::uint64_t newest_us = 0;  ///< of the newest sample, rejected or not, by the agent's clock
    RateLimit samples{0, 0};
    wire::ToolState state;
    Clock::time_point state_at{};
    std::optional<StockFeed> stock;  ///< of one who keeps a copy of the block
  };

  std::optional<Rejection> take_sample(Seat& seat, const wire::MotionSample& sample, BatchSum& sum);
  std::expected<MotionResult, Rejection> carve(ParticipantId who, const MoveTool& move);
  std::optional<wire::ToolState> felt_by(const Seat& seat) const;
  static void show(Seat& seat, const wire::Result& result, const BatchSum& sum);
  void run_programs();
  std::expected<double, Rejection> carve_program_motion(ParticipantId who,
                                                        const ProgramMotion& motion, bool feel);
  void retire_programs();
  void hash_soon();
  void start_hash();
  void tell(const SessionEvent& event);

  std::shared_ptr<Executor> executor_;  ///< first, so that it goes last
  std::string id_;
  Scene scene_;
  Sculpture sculpture_;
  JournalWriter journal_;
  SessionLimits limits_;
  Executor& workers_;
  std::map<ParticipantId, Seat> seats_;
  ParticipantId last_participant_ = 0;
  ProgramRuns programs_;
  bool programs_scheduled_ = false;
  std::map<int, SessionListener> listeners_;
  int last_listener_ = 0;
  std::set<TileIndex> changed_;  ///< since the last frame
  std::uint64_t changed_sequence_ = 0;
  std::optional<StateHash> hash_;
  bool hash_scheduled_ = false;
  std::chrono::microseconds hash_cost_{0};
  std::atomic<std::uint64_t> motions_applied_{0};
  bool closed_ = false;
};

}  // namespace kerf
