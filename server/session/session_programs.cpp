// SPDX-License-Identifier: Apache-2.0
#include "server/session/session_programs.h"

#include <algorithm>
#include <utility>

#include "server/session/stopped_program.h"
#include "server/wire/limits.h"

namespace kerf {
namespace {

/// Bounds of the pause after a slice while an agent moves. Within them it lasts as long as the
/// slice. One frame of an agent takes several turns of the executor. Without the pause each turn
/// would wait for a slice, and an agent at 1 kHz would fall behind.
constexpr std::chrono::microseconds kPauseMin{200}, kPauseMax{5000};

}  // namespace

SessionPrograms::SessionPrograms(const Parts& parts, SessionOwner owner, Hooks hooks)
    : executor_(parts.executor),
      sculpture_(parts.sculpture),
      journal_(parts.journal),
      participants_(parts.participants),
      carving_(parts.carving),
      owner_(std::move(owner)),
      hooks_(std::move(hooks)) {}

/// Returns the program that a program queued `after` must wait for; 0 if none.
std::expected<ProgramId, Rejection> SessionPrograms::predecessor(ProgramId after) const {
  if (after == 0) return ProgramId{0};
  if (after == kAfterNewest) return runs_.newest_open();
  const auto status = runs_.status(after);
  const std::string name = "program " + std::to_string(after);
  if (!status) {
    return std::unexpected(
        Rejection{wire::ErrorCode::kBadMessage, "the session has no " + name + " to follow"});
  }
  if (!is_ended(status->state)) return after;
  if (status->state == ProgramState::kFinished) return ProgramId{0};
  return std::unexpected(Rejection{wire::ErrorCode::kBadMessage,
                                   name + " has not finished and never will: no program follows"});
}

std::expected<ProgramStatus, Rejection> SessionPrograms::start(ProgramJob job,
                                                               ProgramOptions options,
                                                               const Caller& caller) {
  const auto after = predecessor(options.after);
  if (!after) return std::unexpected(after.error());
  options.after = *after;
  // Reject unknown tools before the first motion is carved.
  for (const ProgramTotals::Use& use : job.totals.tools) {
    if (sculpture_.tool(use.tool) != nullptr) continue;
    const Rejection rejection = unknown_tool(use.tool);
    return std::unexpected(Rejection{
        rejection.code, job.name + ":" + std::to_string(use.line) + ": " + rejection.reason});
  }
  JoinRequest request;
  request.kind = ParticipantKind::kProgram;
  request.role = caller.role;
  request.grant = caller.grant;
  request.is_personal = caller.is_personal;
  request.invitation = caller.invitation;
  request.is_muted = caller.is_muted;
  request.name = job.name.substr(0, wire::kMaxNameBytes);
  if (!job.totals.tools.empty()) request.tool = job.totals.tools.front().tool;
  const auto joined = hooks_.join(request);
  if (!joined) return std::unexpected(joined.error());
  options.author = caller.grant;
  options.tolerance_mm = sculpture_.settings().tolerance_mm;
  const auto text = options.text;
  ProgramStatus status = runs_.start(joined->id, std::move(job), std::move(options), Clock::now());
  if (text && !is_ended(status.state)) journal_.attach(stored(status, text->text));
  schedule();
  return status;
}

/// Schedules slices unless they are already scheduled. They stop when no program is running.
void SessionPrograms::schedule() {
  if (std::exchange(is_scheduled_, true)) return;
  executor_.post([this, session = owner_.hold()] { run(); });
}

bool SessionPrograms::order(ProgramId id, ProgramOrder order) {
  const bool done = runs_.order(id, order, Clock::now());
  schedule();
  return done;
}

bool SessionPrograms::set_pace(ProgramId id, ProgramPace pace, double speed) {
  return runs_.set_pace(id, pace, speed, Clock::now());
}

std::optional<std::vector<ProgramGlance>> SessionPrograms::update(bool all) {
  const auto now = Clock::now();
  const bool is_due = runs_.changes() != sent_ && now - sent_at_ >= kUpdateInterval;
  if (runs_.changes() == 0 || (!all && !is_due)) return std::nullopt;
  sent_ = runs_.changes();
  sent_at_ = now;
  return runs_.glances();
}

void SessionPrograms::run() {
  const auto start = Clock::now();
  const std::uint64_t removal_before = journal_.removal_sequence();
  const auto wait =
      runs_.slice([this](const ProgramStep& step) { return carving_.move(step); },
                  [this](ParticipantId id, const ToolPose& pose) { carving_.show(id, pose); });
  const bool removed = journal_.removal_sequence() != removal_before;
  retire(true);
  hooks_.carved(removed);
  if (!wait) {
    is_scheduled_ = false;
    return;
  }
  auto pause = *wait;
  if (pause.count() == 0 && participants_.has_active_agent(Participants::kAgentIsActive)) {
    const auto spent = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - start);
    pause = std::clamp(spent, kPauseMin, kPauseMax);
  }
  Work next_slice = [this, session = owner_.hold()] { run(); };
  if (pause.count() == 0) {
    executor_.post(std::move(next_slice));
  } else {
    executor_.post_after(pause, std::move(next_slice));
  }
}

void SessionPrograms::list_stopped(const std::vector<Attachment>& attachments) {
  const auto lines = read_program_lines(journal_.file());
  if (!lines) return;  // the next start lists them
  for (StoppedProgram& program : stopped_programs(attachments, *lines)) {
    journal_.attach(ended_program(program.status.participant));
    runs_.add_ended(std::move(program.status), std::move(program.text));
  }
}

/// `for_good`: also deletes their attachments.
void SessionPrograms::retire(bool for_good) {
  for (const ParticipantId id : runs_.take_ended()) {
    carving_.end_program(id);
    if (for_good) journal_.attach(ended_program(id));
    hooks_.leave(id);
  }
}

bool SessionPrograms::cancel(ProgramId id) {
  const bool cancelled = runs_.cancel(id);
  retire(true);
  return cancelled;
}

void SessionPrograms::close() {
  runs_.cancel_all();
  retire(false);
}

}  // namespace kerf
