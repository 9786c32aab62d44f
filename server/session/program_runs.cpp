// SPDX-License-Identifier: Apache-2.0
#include "server/session/program_runs.h"

#include <algorithm>
#include <ranges>
#include <utility>

namespace kerf {
namespace {

/// Reading steps in a row: more than most programs have between two motions.
constexpr int kReads = 16;

}  // namespace

const char* to_string(ProgramState state) {
  switch (state) {
    case ProgramState::kQueued:
      return "queued";
    case ProgramState::kRunning:
      return "running";
    case ProgramState::kPaused:
      return "paused";
    case ProgramState::kFinished:
      return "finished";
    case ProgramState::kCancelled:
      return "cancelled";
    case ProgramState::kFailed:
      return "failed";
  }
  return "failed";
}

ProgramStatus ProgramRuns::start(ParticipantId participant, ProgramJob job, ProgramOptions options,
                                 Clock::time_point now) {
  drop_oldest();
  ++changes_;
  Run run;
  ProgramStatus& status = run.status;
  status.id = ++last_id_;
  status.participant = participant;
  status.name = std::move(job.name);
  status.author = std::move(options.author);
  status.pace = options.pace;
  status.speed = options.speed;
  status.motions = job.totals.motions;
  status.read_as = std::move(job.read_as);
  status.warnings = std::move(job.warnings);
  status.programmed_s = job.totals.duration_s;
  status.machine_s = job.machine_s;
  for (const ProgramTotals::Use& use : job.totals.tools) status.tools.push_back(use.tool);
  if (!status.tools.empty()) status.tool = status.tools.front();
  run.text = std::move(options.text);
  run.motions.emplace(job.open(), job.rate_hz);
  const auto& target = options.target;
  AlarmLimits limits{.force_n = options.force_limit_n, .tolerance_mm = options.tolerance_mm};
  if (target) {
    limits.gouge_mm = target->tolerance_mm;
    limits.pitch_mm = target->part->grid().pitch_mm;
  }
  run.alarms = ProgramAlarms(limits);
  if (target) {
    status.target = target->name;
    status.target_tolerance_mm = target->tolerance_mm;
  }
  run.target = std::move(options.target);
  run.memory = std::move(options.memory);
  run.clock.set_speed(options.speed, now);
  if (options.after != 0) {
    status.state = ProgramState::kQueued;
    status.after = options.after;
  }
  Run& kept = runs_.emplace(status.id, std::move(run)).first->second;
  if (options.after == 0) begin(kept, now);
  return kept.status;
}

void ProgramRuns::add_ended(ProgramStatus status, std::shared_ptr<const ProgramText> text) {
  drop_oldest();
  ++changes_;
  Run run;
  run.status = std::move(status);
  run.status.id = ++last_id_;
  run.text = std::move(text);
  runs_.emplace(last_id_, std::move(run));
  drop_ended_texts(kEndedTextBytesMax);
}

void ProgramRuns::begin(Run& run, Clock::time_point now) {
  run.status.state = ProgramState::kRunning;
  run.clock.run(now);
  if (run.status.motions == 0) return end(run, ProgramState::kFinished);
  read_on(run);
}

void ProgramRuns::read_on(Run& run) {
  for (int reads = 0; run.next() == nullptr && reads < kReads; ++reads) {
    const auto more = run.motions->read();
    if (!more) run.status.error = to_string(more.error());
    if (!more || !*more) return end(run, more ? ProgramState::kFinished : ProgramState::kFailed);
  }
  if (!run.steps || run.next() == nullptr || run.status.state != ProgramState::kRunning) return;
  if (!run.only_line) run.only_line = run.next()->line;
  if (*run.only_line != run.next()->line) pause(run, Clock::now());
}

void ProgramRuns::drop_oldest() {
  if (runs_.size() < kStatusesMax) return;
  const auto oldest = std::ranges::find_if(
      runs_, [](const auto& entry) { return is_ended(entry.second.status.state); });
  if (oldest != runs_.end()) runs_.erase(oldest);
}

void ProgramRuns::end(Run& run, ProgramState state) {
  ++changes_;
  run.status.state = state;
  run.status.waiting = false;
  ended_.push_back(run.status.participant);
  // An ended run keeps only its status and text.
  run.motions.reset();
  run.target.reset();
  run.memory = MemoryBudget::Share();
  drop_ended_texts(kEndedTextBytesMax);
  end_wait(run.status);
}

void ProgramRuns::end_wait(const ProgramStatus& ended) {
  for (auto& run : runs_ | std::views::values) {
    if (run.status.state != ProgramState::kQueued || run.status.after != ended.id) continue;
    if (ended.state == ProgramState::kFinished) {
      begin(run, Clock::now());
    } else {
      run.status.error = "program " + std::to_string(ended.id) + ", which it was to follow, " +
                         (ended.state == ProgramState::kFailed ? "failed" : "was cancelled");
      end(run, ProgramState::kCancelled);
    }
  }
}

void ProgramRuns::drop_ended_texts(std::size_t bytes_max) {
  std::size_t bytes = 0;
  for (auto& run : runs_ | std::views::values | std::views::reverse) {
    if (!run.text || !is_ended(run.status.state)) continue;
    bytes += run.text->text.size();
    if (bytes > bytes_max) run.text.reset();
  }
}

std::shared_ptr<const ProgramText> ProgramRuns::text(ProgramId id) const {
  const auto found = runs_.find(id);
  return found == runs_.end() ? nullptr : found->second.text;
}

void ProgramRuns::pause(Run& run, Clock::time_point now) {
  ++changes_;
  run.pauses = run.steps = false;
  run.only_line.reset();
  run.status.waiting = false;
  run.status.state = ProgramState::kPaused;
  run.clock.stop(now);
}

bool ProgramRuns::order(ProgramId id, ProgramOrder order, Clock::time_point now) {
  const auto found = runs_.find(id);
  if (found == runs_.end()) return false;
  Run& run = found->second;
  ProgramState& state = run.status.state;
  if (state != ProgramState::kRunning && state != ProgramState::kPaused) return false;
  if (order == ProgramOrder::kPause) {
    if (run.in_pieces) {
      run.pauses = true;
    } else if (state == ProgramState::kRunning) {
      pause(run, now);
    }
    return true;
  }
  ++changes_;
  run.pauses = false;
  run.only_line.reset();
  run.steps = order == ProgramOrder::kStep;
  if (run.steps && run.next() != nullptr) run.only_line = run.next()->line;
  run.align(now);
  run.clock.run(now);
  state = ProgramState::kRunning;
  return true;
}

bool ProgramRuns::set_pace(ProgramId id, ProgramPace pace, double speed, Clock::time_point now) {
  const auto found = runs_.find(id);
  if (found == runs_.end() || is_ended(found->second.status.state)) return false;
  Run& run = found->second;
  ++changes_;
  run.status.pace = pace;
  run.status.speed = speed;
  run.clock.set_speed(speed, now);
  if (run.status.state != ProgramState::kQueued) run.align(now);
  return true;
}

bool ProgramRuns::cancel(ProgramId id) {
  const auto found = runs_.find(id);
  if (found == runs_.end() || is_ended(found->second.status.state)) return false;
  end(found->second, ProgramState::kCancelled);
  return true;
}

void ProgramRuns::cancel_all() {
  for (auto& run : runs_ | std::views::values) cancel(run.status.id);
}

std::optional<ProgramStatus> ProgramRuns::status(ProgramId id) const {
  const auto found = runs_.find(id);
  if (found == runs_.end()) return std::nullopt;
  return found->second.status_now();
}

std::vector<ProgramGlance> ProgramRuns::glances() const {
  std::vector<ProgramGlance> glances;
  std::size_t ended = 0;
  for (const auto& run : runs_ | std::views::values | std::views::reverse) {
    if (is_ended(run.status.state) && ++ended > kEndedShown) continue;
    glances.push_back(run.status);
    glances.back().elapsed_s += run.in_motion_s;
  }
  std::ranges::reverse(glances);
  return glances;
}

std::vector<ProgramStatus> ProgramRuns::list() const {
  std::vector<ProgramStatus> list;
  for (const auto& run : runs_ | std::views::values) list.push_back(run.status_now());
  return list;
}

ProgramId ProgramRuns::newest_open() const {
  for (const auto& run : runs_ | std::views::values | std::views::reverse) {
    if (!is_ended(run.status.state)) return run.status.id;
  }
  return 0;
}

std::size_t ProgramRuns::running() const {
  return static_cast<std::size_t>(std::ranges::count_if(runs_ | std::views::values, [](auto& run) {
    return run.status.state == ProgramState::kRunning;
  }));
}

std::vector<ParticipantId> ProgramRuns::take_ended() { return std::exchange(ended_, {}); }

bool ProgramRuns::due(const Run& run, Clock::time_point now) const {
  if (run.status.state != ProgramState::kRunning) return false;
  if (run.status.pace == ProgramPace::kFast || run.next() == nullptr) return true;
  // A motion is carved when its time has passed, as for an agent.
  return run.clock.now_s(now) >= run.status.elapsed_s + run.next()->duration_s;
}

void ProgramRuns::show_on_motion(Run& run, const Show& show, Clock::time_point now) {
  const ProgramMotion* motion = run.next();
  const ProgramStatus& status = run.status;
  const bool moves = status.state == ProgramState::kRunning && status.pace == ProgramPace::kFeed;
  if (!moves || motion == nullptr || run.in_pieces) return;
  const double passed_s = run.clock.now_s(now) - status.elapsed_s;
  if (!(passed_s > 0 && passed_s < motion->duration_s)) return;
  run.in_motion_s = passed_s;
  ++changes_;
  show(status.participant, pose_on(*motion, passed_s / motion->duration_s));
}

bool ProgramRuns::step(Run& run, const Carve& carve) {
  if (run.next() == nullptr) {
    read_on(run);
    return true;
  }
  const ProgramMotion& motion = *run.next();
  ProgramStatus& status = run.status;
  const auto carved = carve({status.participant, motion, status.pace == ProgramPace::kFeed,
                             status.motions_done + 1 == status.motions, run.target.get()});
  ++changes_;
  status.waiting = !carved && carved.error().code == wire::ErrorCode::kBusy;
  if (status.waiting) return false;
  status.line = motion.line;
  status.tool = motion.tool;
  if (!carved) {
    status.error = status.name + ":" + std::to_string(motion.line) + ": " + carved.error().reason;
    end(run, ProgramState::kFailed);
    return true;
  }
  run.in_pieces = !*carved;
  if (!run.in_pieces) advance(run, **carved);
  return true;
}

void ProgramRuns::advance(Run& run, const CarvedMotion& carved) {
  const ProgramMotion& motion = *run.next();
  ProgramStatus& status = run.status;
  run.alarms.follow(motion, carved);
  status.alarm_count = run.alarms.count();
  status.removed_mm3 += carved.removed_mm3;
  status.elapsed_s += motion.duration_s;
  run.in_motion_s = 0;
  status.feed_mm_per_min = length(motion.to.tip_mm - motion.from.tip_mm) / motion.duration_s * 60;
  if (++status.motions_done == status.motions) return end(run, ProgramState::kFinished);
  run.motions->pop();
  if (run.pauses) pause(run, Clock::now());
  read_on(run);
}

std::optional<std::chrono::microseconds> ProgramRuns::slice(const Carve& carve, const Show& show) {
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
  for (auto& run : runs_ | std::views::values) show_on_motion(run, show, now);
  if (busy) return kBusyPause;
  const bool more_due = std::ranges::any_of(runs_ | std::views::values,
                                            [&](const Run& run) { return due(run, now); });
  return more_due ? std::chrono::microseconds{0} : std::chrono::microseconds{1000};
}

}  // namespace kerf
