// SPDX-License-Identifier: Apache-2.0
#include "server/session/program_runs.h"

#include <algorithm>
#include <ranges>
#include <utility>

namespace kerf {

const char* to_string(ProgramState state) {
  switch (state) {
    case ProgramState::kRunning:
      return "running";
    case ProgramState::kFinished:
      return "finished";
    case ProgramState::kCancelled:
      return "cancelled";
    case ProgramState::kFailed:
      return "failed";
  }
  return "failed";
}

ProgramStatus ProgramRuns::start(ParticipantId participant, Program program, ProgramPace pace,
                                 Clock::time_point now, MemoryBudget::Share memory) {
  drop_oldest();
  Run run;
  run.status.id = ++last_id_;
  run.status.participant = participant;
  run.status.name = program.name;
  run.status.pace = pace;
  run.status.motions = program.motions.size();
  run.status.warnings = program.warnings;
  for (const ProgramMotion& motion : program.motions) run.status.programmed_s += motion.duration_s;
  run.program = std::move(program);
  run.started = now;
  run.memory = std::move(memory);
  if (run.status.motions == 0) end(run, ProgramState::kFinished);
  return runs_.emplace(run.status.id, std::move(run)).first->second.status;
}

void ProgramRuns::drop_oldest() {
  if (runs_.size() < kStatusesMax) return;
  const auto oldest = std::ranges::find_if(
      runs_, [](const auto& entry) { return entry.second.status.state != ProgramState::kRunning; });
  if (oldest != runs_.end()) runs_.erase(oldest);
}

void ProgramRuns::end(Run& run, ProgramState state) {
  run.status.state = state;
  run.status.waiting = false;
  ended_.push_back(run.status.participant);
  // A finished run keeps its status only. Assigning {} to the vector would keep its memory.
  run.program = Program();
  run.memory = MemoryBudget::Share();
}

bool ProgramRuns::cancel(ProgramId id) {
  const auto found = runs_.find(id);
  if (found == runs_.end() || found->second.status.state != ProgramState::kRunning) return false;
  end(found->second, ProgramState::kCancelled);
  return true;
}

void ProgramRuns::cancel_all() {
  for (auto& run : runs_ | std::views::values) cancel(run.status.id);
}

std::optional<ProgramStatus> ProgramRuns::status(ProgramId id) const {
  const auto found = runs_.find(id);
  if (found == runs_.end()) return std::nullopt;
  return found->second.status;
}

std::vector<ProgramStatus> ProgramRuns::list() const {
  std::vector<ProgramStatus> list;
  for (const auto& run : runs_ | std::views::values) list.push_back(run.status);
  return list;
}

std::size_t ProgramRuns::running() const {
  return static_cast<std::size_t>(std::ranges::count_if(runs_ | std::views::values, [](auto& run) {
    return run.status.state == ProgramState::kRunning;
  }));
}

std::size_t ProgramRuns::memory_bytes() const {
  std::size_t bytes = 0;
  for (const auto& run : runs_ | std::views::values) {
    bytes += run.program.motions.capacity() * sizeof(ProgramMotion);
  }
  return bytes;
}

std::vector<ParticipantId> ProgramRuns::take_ended() { return std::exchange(ended_, {}); }

bool ProgramRuns::due(const Run& run, Clock::time_point now) const {
  if (run.status.state != ProgramState::kRunning) return false;
  if (run.status.pace == ProgramPace::kFast) return true;
  // A motion is carved when its time has passed, as for an agent.
  const double end_s = run.done_s + run.program.motions[run.status.motions_done].duration_s;
  return std::chrono::duration<double>(now - run.started).count() >= end_s;
}

bool ProgramRuns::step(Run& run, const Carve& carve) {
  const ProgramMotion& motion = run.program.motions[run.status.motions_done];
  const auto removed_mm3 =
      carve({run.status.participant, motion, run.status.pace == ProgramPace::kFeed,
             run.status.motions_done + 1 == run.status.motions});
  run.status.waiting = !removed_mm3 && removed_mm3.error().code == wire::ErrorCode::kBusy;
  if (run.status.waiting) return false;
  run.status.line = motion.line;
  if (!removed_mm3) {
    run.status.error =
        run.status.name + ":" + std::to_string(motion.line) + ": " + removed_mm3.error().reason;
    end(run, ProgramState::kFailed);
    return true;
  }
  if (!*removed_mm3) return true;
  run.status.removed_mm3 += **removed_mm3;
  run.done_s += motion.duration_s;
  if (++run.status.motions_done == run.status.motions) end(run, ProgramState::kFinished);
  return true;
}

std::optional<std::chrono::microseconds> ProgramRuns::slice(const Carve& carve) {
  const auto start = Clock::now();
  auto now = start;
  bool more = true, busy = false;
  while (more && !busy && now - start < kSlice) {
    more = false;
    for (auto& run : runs_ | std::views::values) {
      if (!due(run, now)) continue;
      busy = !step(run, carve) || busy;
      more = true;
    }
    now = Clock::now();
  }
  if (running() == 0) return std::nullopt;
  if (busy) return kBusyPause;
  const bool more_due = std::ranges::any_of(runs_ | std::views::values,
                                            [&](const Run& run) { return due(run, now); });
  return more_due ? std::chrono::microseconds{0} : std::chrono::microseconds{1000};
}

}  // namespace kerf
