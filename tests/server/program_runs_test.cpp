// SPDX-License-Identifier: Apache-2.0
#include "server/session/program_runs.h"

#include "server/platform/clock.h"
#include "tests/support/test.h"

namespace kerf::program_runs_test {
namespace {

using Carved = std::expected<std::optional<CarvedMotion>, Rejection>;

Program program_of(std::size_t motions, double duration_s = 0.001) {
  Program program{.name = "p.ngc"};
  for (std::size_t i = 0; i < motions; ++i) {
    ProgramMotion motion{.tool = 1,
                         .from = {.tip_mm = {.x = static_cast<double>(i)}},
                         .to = {.tip_mm = {.x = static_cast<double>(i + 1)}},
                         .duration_s = duration_s,
                         .line = static_cast<std::uint32_t>(i + 10)};
    program.motions.push_back(motion);
  }
  return program;
}

Carved quick_cut(const ProgramStep&) { return CarvedMotion{0.5}; }

Carved slow_cut(const ProgramStep&) {
  std::this_thread::sleep_for(std::chrono::microseconds(200));
  return CarvedMotion{0.5};
}

TEST(ProgramRuns, FastProgramIsCarvedInSlices) {
  ProgramRuns runs;
  const auto id = runs.start(1, program_of(50), {ProgramPace::kFast}, Clock::now()).id;
  EXPECT_EQ(test::value_of(runs.slice(slow_cut)).count(), 0);
  EXPECT_LT(runs.status(id)->motions_done, 10U);
  while (runs.slice(slow_cut)) {
  }
  EXPECT_EQ(runs.status(id)->state, ProgramState::kFinished);
  EXPECT_EQ(runs.status(id)->removed_mm3, 25);
  EXPECT_EQ(runs.status(id)->line, 59U);
  EXPECT_EQ(runs.take_ended(), std::vector<ParticipantId>{1});
  EXPECT_TRUE(runs.take_ended().empty());
}

TEST(ProgramRuns, IncompleteMotionIsRepeated) {
  ProgramRuns runs;
  const auto id = runs.start(1, program_of(3), {ProgramPace::kFast}, Clock::now()).id;
  std::vector<double> calls;
  while (runs.slice([&](const ProgramStep& step) -> Carved {
    calls.push_back(step.motion.from.tip_mm.x);
    if (calls.size() == 2 || calls.size() == 3) return std::nullopt;
    return CarvedMotion{0.5};
  })) {
  }
  EXPECT_EQ(calls, (std::vector<double>{0, 1, 1, 1, 2}));
  EXPECT_EQ(runs.status(id)->motions_done, 3U);
  EXPECT_EQ(runs.status(id)->removed_mm3, 1.5);
}

TEST(ProgramRuns, ProgramsAlternate) {
  ProgramRuns runs;
  std::vector<ParticipantId> order;
  runs.start(1, program_of(4), {ProgramPace::kFast}, Clock::now());
  runs.start(2, program_of(4), {ProgramPace::kFast}, Clock::now());
  while (runs.slice([&](const ProgramStep& step) {
    order.push_back(step.participant);
    return Carved(CarvedMotion{});
  })) {
  }
  EXPECT_EQ(order, (std::vector<ParticipantId>{1, 2, 1, 2, 1, 2, 1, 2}));
}

TEST(ProgramRuns, EndedProgramReleasesItsMemory) {
  MemoryBudget budget(1'000'000);
  ProgramRuns runs;
  const auto start = [&] {
    auto memory = budget.take(300'000);
    return runs
        .start(1, program_of(1000), {.pace = ProgramPace::kFast, .memory = *std::move(memory)},
               Clock::now())
        .id;
  };
  start();
  EXPECT_EQ(budget.taken(), 300'000U);
  while (runs.slice(quick_cut)) {
  }
  EXPECT_EQ(budget.taken(), 0U);
  runs.cancel(start());
  EXPECT_EQ(budget.taken(), 0U);
  start();
  runs.slice([](const ProgramStep&) -> Carved {
    return std::unexpected(Rejection{wire::ErrorCode::kBadPose, "too far"});
  });
  EXPECT_EQ(budget.taken(), 0U);
}

TEST(MemoryBudget, SharesAreTakenAndReturned) {
  MemoryBudget budget(100);
  auto one = test::value_of(budget.take(60));
  EXPECT_FALSE(budget.take(41));
  auto two = budget.take(40);
  ASSERT_TRUE(two);
  EXPECT_FALSE(budget.take(1));
  one.reduce(10);
  one.reduce(20);
  EXPECT_EQ(one.bytes(), 10U);
  EXPECT_EQ(budget.taken(), 50U);
  MemoryBudget::Share moved = std::move(*two);
  two.reset();
  EXPECT_EQ(budget.taken(), 50U);
  moved = MemoryBudget::Share();
  EXPECT_EQ(budget.taken(), 10U);
  EXPECT_FALSE(budget.take(~std::size_t{0}));
}

TEST(ProgramRuns, ToolMovesAlongAFutureMotion) {
  ProgramRuns runs;
  const auto show = [&](ProgramPace pace, double passed_s) {
    const auto start = Clock::now() - std::chrono::duration_cast<Clock::duration>(
                                          std::chrono::duration<double>(passed_s));
    runs.cancel_all();
    runs.start(7, program_of(2, 1000), {pace}, start);
    std::vector<double> x_mm;
    runs.slice(
        [](const ProgramStep&) -> Carved {
          return std::unexpected(Rejection{wire::ErrorCode::kBusy, "not now"});
        },
        [&](ParticipantId who, const ToolPose& pose) {
          EXPECT_EQ(who, 7U);
          x_mm.push_back(pose.tip_mm.x);
        });
    return x_mm;
  };
  const auto x_mm = show(ProgramPace::kFeed, 250);
  EXPECT_GE(runs.glances().back().elapsed_s, 250) << "its time passes";
  EXPECT_EQ(runs.glances().back().motions_done, 0U);
  ASSERT_EQ(x_mm.size(), 1U);
  EXPECT_GE(x_mm[0], 0.25);
  EXPECT_LT(x_mm[0], 1);
  EXPECT_TRUE(show(ProgramPace::kFast, 250).empty());
}

TEST(ProgramRuns, FeedRateMotionIsCarvedWhenItsTimeHasPassed) {
  ProgramRuns runs;
  const auto start = Clock::now();
  const auto early = runs.start(1, program_of(3, 1000), {ProgramPace::kFeed}, start).id;
  const auto late =
      runs.start(2, program_of(3, 1), {ProgramPace::kFeed}, start - std::chrono::seconds(100)).id;
  EXPECT_GT(test::value_of(runs.slice(quick_cut)).count(), 0);
  EXPECT_EQ(runs.status(early)->motions_done, 0U);
  EXPECT_EQ(runs.status(late)->state, ProgramState::kFinished);
}

TEST(ProgramRuns, ForcesAreComputedOnlyAtFeedRate) {
  ProgramRuns runs;
  std::map<ParticipantId, bool> felt;
  runs.start(1, program_of(1), {ProgramPace::kFeed}, Clock::now() - std::chrono::seconds(9));
  runs.start(2, program_of(1), {ProgramPace::kFast}, Clock::now());
  runs.slice([&](const ProgramStep& step) {
    felt[step.participant] = step.feel;
    return Carved(CarvedMotion{});
  });
  EXPECT_TRUE(felt.at(1));
  EXPECT_FALSE(felt.at(2));
}

TEST(ProgramRuns, RejectedMotionFailsTheProgramWithItsLine) {
  ProgramRuns runs;
  const auto id = runs.start(1, program_of(5), {ProgramPace::kFast}, Clock::now()).id;
  int calls = 0;
  const auto wait = runs.slice([&](const ProgramStep&) {
    return ++calls == 3 ? Carved(std::unexpect, Rejection{wire::ErrorCode::kBadPose, "too far"})
                        : Carved(CarvedMotion{1});
  });
  EXPECT_FALSE(wait);
  EXPECT_EQ(runs.status(id)->state, ProgramState::kFailed);
  EXPECT_EQ(runs.status(id)->error, "p.ngc:12: too far");
  EXPECT_EQ(runs.status(id)->motions_done, 2U);
}

TEST(ProgramRuns, BusyMotionIsRetriedAndTheLastOneMarked) {
  ProgramRuns runs;
  const auto id = runs.start(1, program_of(3), {ProgramPace::kFast}, Clock::now()).id;
  bool busy = true;
  std::vector<std::uint32_t> lines;
  const auto carve = [&](const ProgramStep& step) -> Carved {
    if (busy && step.motion.line == 11) {
      return std::unexpected(Rejection{wire::ErrorCode::kBusy, "full"});
    }
    EXPECT_EQ(step.is_last, step.motion.line == 12);
    lines.push_back(step.motion.line);
    return CarvedMotion{1};
  };
  for (int n = 0; n < 3; ++n) {
    EXPECT_EQ(runs.slice(carve), std::optional(ProgramRuns::kBusyPause));
    EXPECT_EQ(runs.status(id)->state, ProgramState::kRunning);
    EXPECT_TRUE(runs.status(id)->waiting);
    EXPECT_EQ(runs.status(id)->motions_done, 1U);
  }
  busy = false;
  EXPECT_FALSE(runs.slice(carve));
  EXPECT_EQ(runs.status(id)->state, ProgramState::kFinished);
  EXPECT_FALSE(runs.status(id)->waiting);
  EXPECT_EQ(lines, (std::vector<std::uint32_t>{10, 11, 12}));
}

TEST(ProgramRuns, CancelledProgramStops) {
  ProgramRuns runs;
  const auto id = runs.start(1, program_of(5), {ProgramPace::kFast}, Clock::now()).id;
  EXPECT_TRUE(runs.cancel(id));
  EXPECT_FALSE(runs.cancel(id));
  EXPECT_FALSE(runs.cancel(id + 1));
  EXPECT_FALSE(runs.slice(slow_cut));
  EXPECT_EQ(runs.status(id)->state, ProgramState::kCancelled);
}

TEST(ProgramRuns, EmptyProgramIsFinishedAtOnce) {
  ProgramRuns runs;
  EXPECT_EQ(runs.start(1, program_of(0), {ProgramPace::kFast}, Clock::now()).state,
            ProgramState::kFinished);
  EXPECT_EQ(runs.take_ended().size(), 1U);
}

TEST(ProgramRuns, OldestFinishedStatusesAreDropped) {
  ProgramRuns runs;
  for (std::size_t i = 0; i < 2 * ProgramRuns::kStatusesMax; ++i) {
    runs.start(1, program_of(0), {ProgramPace::kFast}, Clock::now());
  }
  EXPECT_EQ(runs.list().size(), ProgramRuns::kStatusesMax);
  EXPECT_FALSE(runs.status(1));
}

}  // namespace
}  // namespace kerf::program_runs_test
