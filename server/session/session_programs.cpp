// SPDX-License-Identifier: Apache-2.0
// The part of Session that carves uploaded programs.
#include <algorithm>
#include <ranges>
#include <utility>

#include "server/session/session.h"

namespace kerf {

std::expected<ProgramStatus, Rejection> Session::start_program(Program program, ProgramPace pace) {
  // Unknown tools are found before anything is cut, not in the middle of the work.
  for (const ProgramMotion& motion : program.motions) {
    if (sculpture_.tool(motion.tool) != nullptr) continue;
    return std::unexpected(
        Rejection{wire::ErrorCode::kUnknownTool, program.name + ":" + std::to_string(motion.line) +
                                                     ": the session has no tool " +
                                                     std::to_string(motion.tool)});
  }
  JoinRequest request;
  request.kind = ParticipantKind::kProgram;
  request.name = program.name.substr(0, wire::kMaxNameBytes);
  if (!program.motions.empty()) request.tool = program.motions.front().tool;
  const auto who = join(request);
  if (!who) return std::unexpected(who.error());
  ProgramStatus status = programs_.start(who->id, std::move(program), pace, Clock::now());
  if (!programs_scheduled_) {
    programs_scheduled_ = true;
    executor_->post([self = shared_from_this()] { self->run_programs(); });
  }
  return status;
}

namespace {

/// While an agent moves, a slice is followed by a pause as long as it took, within these bounds.
/// One frame of an agent takes several turns of the executor; without the pause each of them would
/// wait for a slice, and 1 kHz would fall behind.
constexpr std::chrono::microseconds kPauseMin{200}, kPauseMax{5000};
constexpr std::chrono::milliseconds kAgentIsActive{200};

}  // namespace

void Session::run_programs() {
  const auto start = Clock::now();
  const auto wait =
      programs_.slice([this](ParticipantId who, const ProgramMotion& motion, bool feel) {
        return carve_program_motion(who, motion, feel);
      });
  retire_programs();
  if (!wait) {
    programs_scheduled_ = false;
    return;
  }
  const auto now = Clock::now();
  auto pause = *wait;
  const bool agents = std::ranges::any_of(seats_ | std::views::values, [&](const Seat& seat) {
    return seat.who.kind == ParticipantKind::kAgent && now - seat.state_at < kAgentIsActive;
  });
  if (agents && pause.count() == 0) {
    const auto spent = std::chrono::duration_cast<std::chrono::microseconds>(now - start);
    pause = std::clamp(spent, kPauseMin, kPauseMax);
  }
  Work again = [self = shared_from_this()] { self->run_programs(); };
  if (pause.count() == 0) {
    executor_->post(std::move(again));
  } else {
    executor_->post_after(pause, std::move(again));
  }
}

std::expected<double, Rejection> Session::carve_program_motion(ParticipantId who,
                                                               const ProgramMotion& motion,
                                                               bool feel) {
  const auto result =
      carve(who, MoveTool{motion.tool, motion.from, motion.to, motion.duration_s, feel});
  if (!result) return std::unexpected(result.error());
  if (const auto found = seats_.find(who); found != seats_.end()) {
    Seat& seat = found->second;
    const bool other_tool = seat.who.tool != motion.tool;
    seat.who.tool = seat.state.tool_id = motion.tool;
    seat.track.place(motion.to);
    BatchSum sum;
    sum.add(*result, motion.duration_s);
    wire::Result shown;
    sum.write(shown);
    show(seat, shown, sum);
    if (other_tool) tell({});
  }
  return result->removed_mm3;
}

void Session::retire_programs() {
  for (const ParticipantId who : programs_.take_ended()) leave(who);
}

bool Session::cancel_program(ProgramId id) {
  const bool cancelled = programs_.cancel(id);
  retire_programs();
  return cancelled;
}

}  // namespace kerf
