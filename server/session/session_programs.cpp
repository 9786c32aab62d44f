// SPDX-License-Identifier: Apache-2.0
// The part of Session that carves uploaded programs.
#include <algorithm>
#include <utility>

#include "server/session/session.h"
#include "server/wire/limits.h"

namespace kerf {
namespace {

/// Bounds of the pause after a slice while an agent moves; within them it lasts as long as the
/// slice. One frame of an agent takes several turns of the executor; without the pause each turn
/// would wait for a slice, and an agent at 1 kHz would fall behind.
constexpr std::chrono::microseconds kPauseMin{200}, kPauseMax{5000};

}  // namespace

std::expected<ProgramStatus, Rejection> Session::start_program(Program program, ProgramPace pace,
                                                               MemoryBudget::Share memory,
                                                               const Caller& caller) {
  // Reject unknown tools before the first motion is carved.
  for (const ProgramMotion& motion : program.motions) {
    if (sculpture_.tool(motion.tool) != nullptr) continue;
    const Rejection rejection = unknown_tool(motion.tool);
    return std::unexpected(
        Rejection{rejection.code,
                  program.name + ":" + std::to_string(motion.line) + ": " + rejection.reason});
  }
  JoinRequest request;
  request.kind = ParticipantKind::kProgram;
  request.role = caller.role;
  request.grant = caller.grant;
  request.is_personal = caller.is_personal;
  request.is_muted = caller.is_muted;
  request.name = program.name.substr(0, wire::kMaxNameBytes);
  if (!program.motions.empty()) request.tool = program.motions.front().tool;
  const auto joined = join(request);
  if (!joined) return std::unexpected(joined.error());
  ProgramStatus status =
      programs_.start(joined->id, std::move(program), pace, Clock::now(), std::move(memory));
  if (!programs_scheduled_) {
    programs_scheduled_ = true;
    executor_->post([self = shared_from_this()] { self->run_programs(); });
  }
  return status;
}

void Session::run_programs() {
  const auto start = Clock::now();
  const std::uint64_t removal_before = journal_.removal_sequence();
  const auto wait =
      programs_.slice([this](const ProgramStep& step) { return carving_.move(step); });
  if (journal_.removal_sequence() != removal_before) schedule_hash();
  retire_programs();
  show_figures();
  write_snapshot_if_due();
  read_history_ahead();
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

void Session::retire_programs() {
  for (const ParticipantId id : programs_.take_ended()) {
    carving_.end_program(id);
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
