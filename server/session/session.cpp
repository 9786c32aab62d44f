// SPDX-License-Identifier: Apache-2.0
#include "server/session/session.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "kernel/cut/workers.h"

namespace kerf {
namespace {

SessionTools& add_tools(SharedScene& scene, std::span<const ListRow> rows, Sculpture& sculpture,
                        SessionJournal& journal, Participants& participants,
                        SessionMatters& matters) {
  auto tools = std::make_unique<SessionTools>(scene, rows, sculpture, journal, participants);
  SessionTools& added = *tools;
  matters.add(std::move(tools));
  return added;
}

Rejection session_closed() { return {wire::ErrorCode::kUnknownSession, "the session is closed"}; }

}  // namespace

Session::Session(std::string id, Replayed replayed, SessionJournal journal, SessionLimits limits,
                 std::shared_ptr<Executor> executor, Executor& workers,
                 std::span<const MakeMatter> matters)
    : executor_(std::move(executor)),
      id_(std::move(id)),
      sculpture_(std::move(replayed.sculpture)),
      limits_(limits),
      journal_(std::move(journal)),
      past_(sculpture_.settings(), std::move(replayed.start), replayed.base, journal_, *executor_,
            SessionOwner([this] { return weak_from_this(); })),
      participants_(limits_, sculpture_, journal_, replayed.scene.tools.begin()->first,
                    replayed.last_participant, std::move(replayed.resumable)),
      carving_(limits_, sculpture_, journal_, participants_),
      stroke_changes_({*executor_, sculpture_, journal_, past_, participants_, carving_}, workers,
                      SessionOwner([this] { return weak_from_this(); }),
                      [this] {
                        show_figures();
                        hashes_.schedule();
                      }),
      snapshots_({id_, *executor_, sculpture_, journal_, carving_},
                 {{}, replayed.snapshot_sequence, replayed.replay_time, Clock::now()},
                 replayed.snapshot, SessionOwner([this] { return weak_from_this(); }),
                 [this] { return is_between_records(); }),
      programs_({*executor_, sculpture_, journal_, participants_, carving_},
                SessionOwner([this] { return weak_from_this(); }),
                {[this](const JoinRequest& request) { return join(request); },
                 [this](ParticipantId ended) { leave(ended); },
                 [this](bool removed) { end_turn(removed); }}),
      hashes_({*executor_, sculpture_, journal_}, workers,
              SessionOwner([this] { return weak_from_this(); }),
              [this] { return is_between_records(); }),
      replicas_(sculpture_, participants_),
      scene_(std::move(replayed.scene)),
      matters_(matters, journal_),
      tools_(add_tools(scene_, replayed.lists[kMadeToolsTable], sculpture_, journal_, participants_,
                       matters_)),
      parent_(std::move(replayed.parent)) {
  matters_.add(std::make_unique<SessionName>(scene_, matters_.block()));
  matters_.restore(replayed.lists);
  participants_.defer_changes([this] { report_changes(); });
  show_figures();
}

Session::~Session() = default;

void Session::keep_snapshots(SnapshotOptions options) {
  if (options.writer != nullptr) {
    past_.read_ahead_on(*options.writer);
    stroke_changes_.work_on(*options.writer);
  }
  snapshots_.keep(std::move(options));
}

void Session::show_figures() {
  figures_.show(sculpture_.motions(), sculpture_.removed_volume_mm3(), participants_.count());
}

void Session::leave(ParticipantId id) {
  forget_batch(id);
  participants_.leave(id);
  carving_.costs().forget(id);
  if (participants_.count() == 0) past_.forget();
  show_figures();
}

/// Drops the rest of a participant's batch and completes its partly cut motion.
void Session::forget_batch(ParticipantId id) {
  carving_.leave(id);
  if (carving_.is_between_records()) {
    executor_->post([self = shared_from_this()] { self->finish_left(); });
  }
}

/// Reports the first change after a quiet period at once, and batches those that follow.
void Session::report_changes() {
  const auto now = Clock::now();
  const auto next = changes_reported_ + kChangeInterval;
  if (now >= next || changes_reported_ == Clock::time_point{}) {
    changes_reported_ = now;
    return participants_.notify_changes();
  }
  const auto wait = std::chrono::ceil<std::chrono::microseconds>(next - now);
  executor_->post_after(wait, [weak = weak_from_this()] {
    const auto self = weak.lock();
    if (!self || self->closed_) return;
    self->changes_reported_ = Clock::now();
    self->participants_.notify_changes();
  });
}

std::expected<Admission, Rejection> Session::admit(const JoinRequest& request) {
  if (closed_) return std::unexpected(session_closed());
  auto admission = participants_.admit(request);
  if (admission && admission->resumed) forget_batch(admission->participant.id);
  show_figures();
  return admission;
}

std::expected<Participant, Rejection> Session::join(const JoinRequest& request) {
  auto admission = admit(request);
  if (!admission) return std::unexpected(admission.error());
  return std::move(admission->participant);
}

std::uint64_t Session::durable_sequence(ParticipantId id) {
  ParticipantState* state = participants_.find(id);
  if (state == nullptr) return 0;
  // Without a lease rejections are not final either: the next owner may accept the samples.
  return state->durable.committed(journal_.is_fenced() ? 0 : journal_.durable_sequence());
}

MotionAnswer Session::rejected_move() const {
  MotionAnswer answer;
  answer.rejections.push_back(
      closed_ ? session_closed()
              : Rejection{wire::ErrorCode::kUnknownSession, "not a participant of the session"});
  return answer;
}

MotionAnswer Session::move(ParticipantId id, std::span<const wire::MotionSample> samples) {
  auto answer = begin_move(id, samples);
  while (!answer) answer = go_on(id);
  return *std::move(answer);
}

std::optional<MotionAnswer> Session::begin_move(ParticipantId id,
                                                std::span<const wire::MotionSample> samples) {
  ParticipantState* state = participants_.find(id);
  if (state == nullptr || closed_) return rejected_move();
  if (carvers_ != nullptr && !carving_.has_batch(id) && has_other_agent(id)) {
    carving_.wait(*state, samples);
    return std::nullopt;
  }
  const std::uint64_t removal_before = journal_.removal_sequence();
  auto answer = carving_.move(*state, samples);
  end_turn(journal_.removal_sequence() != removal_before);
  return answer;
}

std::optional<MotionAnswer> Session::go_on(ParticipantId id) {
  ParticipantState* state = participants_.find(id);
  if (state == nullptr || closed_ || !carving_.has_batch(id)) return rejected_move();
  SerialWorkers alone;
  auto answer = carving_.go_on(*state, carvers_ != nullptr ? *carvers_ : alone);
  end_turn(true);
  return answer;
}

/// Ends a turn in which something may have been carved.
void Session::end_turn(bool removed) {
  if (removed) hashes_.schedule();
  show_figures();
  snapshots_.write_if_due();
  past_.read_ahead();
}

void Session::remove_holders(std::span<const std::string> grants, const std::string& reason) {
  for (const ProgramStatus& program : programs_.list()) {
    const ParticipantState* state = participants_.find(program.participant);
    if (state == nullptr || std::ranges::find(grants, state->grant) == grants.end()) continue;
    programs_.cancel(program.id);
  }
  participants_.remove_holders(grants, reason);
}

void Session::finish_left() {
  if (closed_ || !carving_.finish_left()) return hashes_.schedule();
  executor_->post([self = shared_from_this()] { self->finish_left(); });
}

wire::Intents Session::intents(ParticipantId id) {
  const ParticipantState* state = participants_.find(id);
  return state == nullptr || closed_ ? wire::Intents{} : participants_.near(*state);
}

SessionFrame Session::frame(bool with_snapshot) {
  SessionFrame frame;
  frame.sequence = sequence();
  frame.motions = sculpture_.motions();
  frame.removed_mm3 = sculpture_.removed_volume_mm3();
  frame.hash = journal_.newest_hash();
  frame.hash_is_current = current_hash().has_value();
  if (const auto error = pause()) frame.paused = pause_word(error->code);
  frame.programs = programs_.update(with_snapshot);
  frame.matters = matters_.updates(with_snapshot);
  frame.tools.tools = participants_.tool_states();
  show_live(frame, with_snapshot);
  frame.changed = carving_.take_changed();
  if (!frame.changed.empty() || with_snapshot) frame.snapshot = sculpture_.solid();
  return frame;
}

SessionInfo Session::info() const {
  SessionInfo info;
  info.id = id_;
  info.sequence = journal_.sequence();
  info.motions = sculpture_.motions();
  info.sub_motions = sculpture_.sub_motions();
  info.stock_mm3 = sculpture_.stock_volume_mm3();
  info.removed_mm3 = sculpture_.removed_volume_mm3();
  info.imprint_mm3 = sculpture_.imprint_volume_mm3();
  info.journal_lag = journal_.lag();
  if (const auto error = pause()) info.paused = pause_word(error->code);
  info.epoch = journal_.epoch();
  info.participants = participants();
  return info;
}

void Session::close(const std::string& reason, const std::string& redirect) {
  if (closed_) return;
  programs_.close();
  closed_ = true;
  past_.close();
  stroke_changes_.close();
  hashes_.close();
  replicas_.close();
  matters_.close();
  snapshots_.close();
  participants_.notify(
      {.closing = reason.empty() ? "the session is closed" : reason, .redirect = redirect});
  participants_.unlisten_all();
}

}  // namespace kerf
