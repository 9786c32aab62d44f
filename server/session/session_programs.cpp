// SPDX-License-Identifier: Apache-2.0
// The part of Session that carves uploaded programs.
#include <algorithm>
#include <utility>

#include "server/session/session.h"
#include "server/session/stopped_program.h"
#include "server/wire/limits.h"

namespace kerf {
namespace {

/// Bounds of the pause after a slice while an agent moves. Within them it lasts as long as the
/// slice. One frame of an agent takes several turns of the executor. Without the pause each turn
/// would wait for a slice, and an agent at 1 kHz would fall behind.
constexpr std::chrono::microseconds kPauseMin{200}, kPauseMax{5000};

}  // namespace

/// Returns the program that a program queued `after` must wait for; 0 if none.
std::expected<ProgramId, Rejection> Session::predecessor(ProgramId after) const {
  if (after == 0) return ProgramId{0};
  if (after == kAfterNewest) return programs_.newest_open();
  const auto status = programs_.status(after);
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

std::expected<ProgramStatus, Rejection> Session::start_program(ProgramJob job,
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
  const auto joined = join(request);
  if (!joined) return std::unexpected(joined.error());
  options.author = caller.grant;
  options.tolerance_mm = sculpture_.settings().tolerance_mm;
  const auto text = options.text;
  ProgramStatus status =
      programs_.start(joined->id, std::move(job), std::move(options), Clock::now());
  if (text && !is_ended(status.state)) attach(stored(status, text->text));
  schedule_programs();
  return status;
}

/// Schedules slices unless they are already scheduled. They stop when no program is running.
void Session::schedule_programs() {
  if (std::exchange(programs_scheduled_, true)) return;
  executor_->post([self = shared_from_this()] { self->run_programs(); });
}

bool Session::order_program(ProgramId id, ProgramOrder order) {
  const bool done = programs_.order(id, order, Clock::now());
  schedule_programs();
  return done;
}

bool Session::set_program_pace(ProgramId id, ProgramPace pace, double speed) {
  return programs_.set_pace(id, pace, speed, Clock::now());
}

std::optional<std::vector<ProgramGlance>> Session::program_update(bool all) {
  const auto now = Clock::now();
  const bool is_due =
      programs_.changes() != programs_sent_ && now - programs_sent_at_ >= kProgramUpdateInterval;
  if (programs_.changes() == 0 || (!all && !is_due)) return std::nullopt;
  programs_sent_ = programs_.changes();
  programs_sent_at_ = now;
  return programs_.glances();
}

void Session::run_programs() {
  const auto start = Clock::now();
  const std::uint64_t removal_before = journal_.removal_sequence();
  const auto wait =
      programs_.slice([this](const ProgramStep& step) { return carving_.move(step); },
                      [this](ParticipantId id, const ToolPose& pose) { carving_.show(id, pose); });
  if (journal_.removal_sequence() != removal_before) schedule_hash();
  retire_programs();
  show_figures();
  snapshots_.write_if_due();
  past_.read_ahead();
  if (!wait) {
    programs_scheduled_ = false;
    return;
  }
  auto pause = *wait;
  if (pause.count() == 0 && participants_.has_active_agent(kAgentIsActive)) {
    const auto spent = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - start);
    pause = std::clamp(spent, kPauseMin, kPauseMax);
  }
  Work next_slice = [self = shared_from_this()] { self->run_programs(); };
  if (pause.count() == 0) {
    executor_->post(std::move(next_slice));
  } else {
    executor_->post_after(pause, std::move(next_slice));
  }
}

void Session::list_stopped(const std::vector<Attachment>& attachments) {
  const auto lines = read_program_lines(journal_.file());
  if (!lines) return;  // the next start lists them
  for (StoppedProgram& program : stopped_programs(attachments, *lines)) {
    attach(ended_program(program.status.participant));
    programs_.add_ended(std::move(program.status), std::move(program.text));
  }
}

void Session::retire_programs(bool for_good) {
  for (const ParticipantId id : programs_.take_ended()) {
    carving_.end_program(id);
    if (for_good) attach(ended_program(id));
    leave(id);
  }
}

void Session::remove_holders(std::span<const std::string> grants, const std::string& reason) {
  for (const ProgramStatus& program : programs()) {
    const ParticipantState* state = participants_.find(program.participant);
    if (state == nullptr || std::ranges::find(grants, state->grant) == grants.end()) continue;
    cancel_program(program.id);
  }
  participants_.remove_holders(grants, reason);
}

bool Session::cancel_program(ProgramId id) {
  const bool cancelled = programs_.cancel(id);
  retire_programs();
  return cancelled;
}

}  // namespace kerf
