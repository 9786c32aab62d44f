// SPDX-License-Identifier: Apache-2.0
// Pausing, stepping, pacing and queueing of programs, and their texts.
#include "server/platform/clock.h"
#include "server/session/stopped_program.h"
#include "tests/server/session_fixture.h"
#include "tests/support/test.h"

namespace kerf::program_control_test {
namespace {

using Carved = std::expected<std::optional<CarvedMotion>, Rejection>;
using std::chrono::seconds;

/// Motions of one second each, on the given lines.
Program program_at(const std::vector<std::uint32_t>& lines) {
  Program program{.name = "p.ngc"};
  for (const std::uint32_t line : lines) {
    ProgramMotion& motion = program.motions.emplace_back();
    motion.tool = line < 100 ? 1 : 2;
    motion.to.tip_mm.x = 5;
    motion.duration_s = 1;
    motion.line = line;
  }
  return program;
}

Carved cut(const ProgramStep&) { return CarvedMotion{1}; }

/// Runs slices until no program is running, at most 100.
void run(ProgramRuns& runs, const ProgramRuns::Carve& carve = cut) {
  for (int n = 0; n < 100 && runs.slice(carve); ++n) {
  }
}

TEST(ProgramControl, PausedProgramContinuesWhereItStopped) {
  ProgramRuns runs;
  const auto id = runs.start(1, program_at({1, 2, 3, 4}), {}, Clock::now()).id;
  std::vector<std::uint32_t> lines;
  const auto carve = [&](const ProgramStep& step) -> Carved {
    lines.push_back(step.motion.line);
    if (lines.size() == 2) runs.order(id, ProgramOrder::kPause, Clock::now());
    return CarvedMotion{1};
  };
  EXPECT_FALSE(runs.slice(carve));
  EXPECT_EQ(runs.running(), 0U);
  EXPECT_EQ(runs.status(id)->state, ProgramState::kPaused);
  EXPECT_TRUE(runs.take_ended().empty());
  EXPECT_FALSE(runs.slice(carve));
  EXPECT_EQ(lines.size(), 2U);
  EXPECT_TRUE(runs.order(id, ProgramOrder::kResume, Clock::now()));
  run(runs, carve);
  EXPECT_EQ(lines, (std::vector<std::uint32_t>{1, 2, 3, 4}));
  EXPECT_EQ(runs.status(id)->state, ProgramState::kFinished);
  EXPECT_FALSE(runs.order(id, ProgramOrder::kResume, Clock::now()));
}

TEST(ProgramControl, PartlyCutMotionIsCompletedBeforeAPause) {
  ProgramRuns runs;
  const auto id = runs.start(1, program_at({1, 2}), {}, Clock::now()).id;
  int calls = 0;
  const auto carve = [&](const ProgramStep&) -> Carved {
    if (++calls < 3) return std::nullopt;
    return CarvedMotion{1};
  };
  ASSERT_TRUE(runs.slice([&](const ProgramStep& step) {
    std::this_thread::sleep_for(ProgramRuns::kSlice);
    return carve(step);
  }));
  ASSERT_EQ(calls, 1);
  runs.order(id, ProgramOrder::kPause, Clock::now());
  EXPECT_EQ(runs.status(id)->state, ProgramState::kRunning);
  run(runs, carve);
  EXPECT_EQ(calls, 3);
  EXPECT_EQ(runs.status(id)->state, ProgramState::kPaused);
  EXPECT_EQ(runs.status(id)->motions_done, 1U);
}

TEST(ProgramControl, AStepCarvesTheMotionsOfOneBlock) {
  ProgramRuns runs;
  const auto id = runs.start(1, program_at({1, 4, 4, 4, 7, 9}), {}, Clock::now()).id;
  runs.order(id, ProgramOrder::kPause, Clock::now());
  const auto step = [&] {
    EXPECT_TRUE(runs.order(id, ProgramOrder::kStep, Clock::now()));
    run(runs);
    return std::pair(runs.status(id)->line, runs.status(id)->state);
  };
  EXPECT_EQ(step(), std::pair(1U, ProgramState::kPaused));
  EXPECT_EQ(step(), std::pair(4U, ProgramState::kPaused));
  EXPECT_EQ(runs.status(id)->motions_done, 4U);
  EXPECT_EQ(step(), std::pair(7U, ProgramState::kPaused));
  EXPECT_EQ(step(), std::pair(9U, ProgramState::kFinished));
}

TEST(ProgramControl, ProgramTimeStopsDuringAPause) {
  ProgramClock clock;
  const auto start = Clock::now();
  clock.run(start);
  EXPECT_EQ(clock.now_s(start + seconds(3)), 3);
  clock.stop(start + seconds(3));
  EXPECT_EQ(clock.now_s(start + seconds(50)), 3);
  clock.run(start + seconds(50));
  clock.set_speed(4, start + seconds(51));
  EXPECT_EQ(clock.now_s(start + seconds(53)), 12);
  clock.clamp(5, 6, start + seconds(53));
  EXPECT_EQ(clock.now_s(start + seconds(54)), 10);
}

TEST(ProgramControl, TheSpeedMultipliesTheFeedRate) {
  ProgramRuns runs;
  const auto start = Clock::now() - seconds(2);
  const auto slow = runs.start(1, program_at({1, 2, 3, 4, 5}), {ProgramPace::kFeed, 0.6}, start).id;
  const auto fast = runs.start(2, program_at({1, 2, 3, 4, 5}), {ProgramPace::kFeed, 2.2}, start).id;
  runs.slice(cut);
  EXPECT_EQ(runs.status(slow)->motions_done, 1U);  // of 1.2 s
  EXPECT_EQ(runs.status(fast)->motions_done, 4U);  // of 4.4 s
  EXPECT_GE(runs.status(fast)->elapsed_s, 4.4);    // the tool is shown on the fifth motion
  EXPECT_LT(runs.status(fast)->elapsed_s, 5);
  EXPECT_EQ(runs.status(fast)->programmed_s, 5);
  EXPECT_EQ(runs.status(fast)->feed_mm_per_min, 300);
  EXPECT_TRUE(runs.set_pace(slow, ProgramPace::kFast, 1, Clock::now()));
  runs.slice(cut);
  EXPECT_EQ(runs.status(slow)->state, ProgramState::kFinished);
  EXPECT_FALSE(runs.set_pace(slow, ProgramPace::kFeed, 1, Clock::now()));
}

TEST(ProgramControl, DelayIsNotMadeUpForAfterAPause) {
  ProgramRuns runs;
  const auto start = Clock::now() - seconds(100);
  const auto id = runs.start(1, program_at({1, 2, 3, 4, 5}), {ProgramPace::kFeed}, start).id;
  runs.order(id, ProgramOrder::kPause, Clock::now());
  runs.order(id, ProgramOrder::kResume, Clock::now());
  runs.slice(cut);
  EXPECT_EQ(runs.status(id)->motions_done, 1U);
}

TEST(ProgramControl, QueuedProgramBeginsWhenItsPredecessorHasFinished) {
  ProgramRuns runs;
  const auto first = runs.start(1, program_at({1, 2}), {}, Clock::now()).id;
  const auto second = runs.start(2, program_at({1}), {.after = first}, Clock::now()).id;
  const auto third = runs.start(3, program_at({}), {.after = second}, Clock::now()).id;
  EXPECT_EQ(runs.newest_open(), third);
  EXPECT_FALSE(runs.order(second, ProgramOrder::kPause, Clock::now()));
  std::vector<ParticipantId> order;
  run(runs, [&](const ProgramStep& step) -> Carved {
    order.push_back(step.participant);
    if (order.size() < 3) {
      EXPECT_EQ(runs.status(third)->state, ProgramState::kQueued);
    }
    return CarvedMotion{1};
  });
  EXPECT_EQ(order, (std::vector<ParticipantId>{1, 1, 2}));
  EXPECT_EQ(runs.status(third)->state, ProgramState::kFinished);
  EXPECT_EQ(runs.newest_open(), 0U);
}

TEST(ProgramControl, ProgramsQueuedBehindAFailureAreCancelled) {
  ProgramRuns runs;
  const auto first = runs.start(1, program_at({1, 2}), {}, Clock::now()).id;
  const auto second = runs.start(2, program_at({1}), {.after = first}, Clock::now()).id;
  const auto third = runs.start(3, program_at({1}), {.after = second}, Clock::now()).id;
  run(runs, [](const ProgramStep&) {
    return Carved(std::unexpect, Rejection{wire::ErrorCode::kBadPose, "too far"});
  });
  EXPECT_EQ(runs.status(second)->state, ProgramState::kCancelled);
  EXPECT_EQ(runs.status(second)->error, "program 1, which it was to follow, failed");
  EXPECT_EQ(runs.status(third)->error, "program 2, which it was to follow, was cancelled");
  EXPECT_EQ(runs.take_ended().size(), 3U);
}

TEST(ProgramControl, TheToolsAreListedInTheOrderOfTheirUse) {
  ProgramRuns runs;
  const auto status = runs.start(1, program_at({100, 1, 2, 101}), {}, Clock::now());
  EXPECT_EQ(status.tools, (std::vector<ToolId>{2, 1}));
  EXPECT_EQ(status.tool, 2U);
}

TEST(ProgramControl, TextsOfTheOldestEndedProgramsAreDropped) {
  MemoryBudget budget(1000);
  ProgramRuns runs;
  const auto start = [&](const std::vector<std::uint32_t>& lines) {
    ProgramOptions options;
    options.text = std::make_shared<const ProgramText>(std::string(100, 'x'), ProgramPath{},
                                                       *budget.take(100));
    return runs.start(1, program_at(lines), std::move(options), Clock::now()).id;
  };
  const auto first = start({}), running = start({1}), last = start({});
  EXPECT_EQ(budget.taken(), 300U);
  runs.drop_ended_texts(150);
  EXPECT_FALSE(runs.text(first));
  ASSERT_TRUE(runs.text(running));
  EXPECT_EQ(runs.text(last)->text, std::string(100, 'x'));
  EXPECT_EQ(budget.taken(), 200U);
  runs.drop_ended_texts(0);
  EXPECT_TRUE(runs.text(running));
  EXPECT_FALSE(runs.text(last));
  EXPECT_TRUE(runs.status(first));
}

TEST_F(SessionTest, PausedProgramSchedulesNothing) {
  const auto session = start();
  Program program = program_at({1, 2});
  for (ProgramMotion& motion : program.motions) motion.from = motion.to = {{0, 0, -1}, {0, 0, 1}};
  const auto id = session->programs().start(program, {ProgramPace::kFeed})->id;
  EXPECT_TRUE(session->programs().order(id, ProgramOrder::kPause));
  for (int n = 0; n < 5; ++n) executor->run_delayed();
  executor->last_delay = std::chrono::microseconds(0);
  executor->run_delayed();
  EXPECT_EQ(executor->last_delay.count(), 0);
  EXPECT_TRUE(session->programs().set_pace(id, ProgramPace::kFast, 1));
  EXPECT_TRUE(session->programs().order(id, ProgramOrder::kResume));
  executor->run();
  EXPECT_EQ(session->programs().status(id)->state, ProgramState::kFinished);
}

class StoppedPrograms : public SessionTest {
 protected:
  void SetUp() override {
    SessionTest::SetUp();
    session = start();
  }
  ProgramId begin(const std::string& name) {
    Program program = program_at({1, 4, 7, 9});
    program.name = name;
    for (ProgramMotion& motion : program.motions) {
      motion.from = {{0, 0, -1}, {0, 0, 1}};
      motion.to = {{0, double(motion.line), -1}, {0, 0, 1}};
    }
    ProgramOptions options{ProgramPace::kFeed, 2.5};
    options.text = std::make_shared<const ProgramText>("text of " + name);
    return session->programs().start(program, std::move(options))->id;
  }
  /// Carves the next line.
  void step(ProgramId id) {
    EXPECT_TRUE(session->programs().order(id, ProgramOrder::kStep));
    for (int n = 0; n < 3; ++n) executor->run_delayed();
  }
  /// Returns the programs that the next server would list as stopped.
  std::vector<StoppedProgram> stopped() {
    EXPECT_TRUE(session->flush());
    return stopped_programs(*read_attachments(session->journal_file()),
                            *read_program_lines(session->journal_file()));
  }
  std::shared_ptr<Session> session;
};

TEST_F(StoppedPrograms, AreListedWithTheLineOfTheirNewestRecord) {
  begin("waits.ngc");
  const ProgramId runs = begin("runs.ngc");
  session->programs().cancel(begin("ends.ngc"));
  EXPECT_TRUE(session->programs().order(runs, ProgramOrder::kPause));
  EXPECT_TRUE(session->programs().set_pace(runs, ProgramPace::kFast, 1));
  step(runs);
  step(runs);
  ASSERT_EQ(session->programs().status(runs)->line, 4U);
  auto list = stopped();
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0].status.name, "waits.ngc");
  EXPECT_TRUE(list[0].status.error.ends_with("before its first motion")) << list[0].status.error;
  EXPECT_EQ(list[0].status.pace, ProgramPace::kFeed);
  EXPECT_EQ(list[0].status.speed, 2.5);
  EXPECT_EQ(list[1].status.line, 4U);
  EXPECT_EQ(list[1].status.motions, 4U);
  EXPECT_EQ(list[1].status.state, ProgramState::kCancelled);
  EXPECT_TRUE(list[1].status.error.ends_with("before line 4 is cut; go on with that line"));
  EXPECT_EQ(list[1].text->text, "text of runs.ngc");
  step(runs);
  step(runs);
  ASSERT_EQ(session->programs().status(runs)->state, ProgramState::kFinished);
  EXPECT_EQ(stopped().size(), 1U) << "one that has finished is not shown again";
}

TEST_F(StoppedPrograms, AreListedOnceAfterTheirServerEnded) {
  begin("job.ngc");
  session->close("the server stops");
  ASSERT_TRUE(session->finish_journal());
  const auto shown = [&] {
    session.reset();
    restart();
    EXPECT_TRUE(registry->load_all().failures.empty());
    session = registry->find("block");
    session->programs().list_stopped(*read_attachments(session->journal_file()));
    EXPECT_TRUE(session->flush());
    return session->programs().list();
  };
  const auto programs = shown();
  ASSERT_EQ(programs.size(), 1U);
  EXPECT_EQ(programs[0].name, "job.ngc");
  EXPECT_EQ(programs[0].participant, 1U);
  EXPECT_EQ(session->programs().text(programs[0].id)->text, "text of job.ngc");
  EXPECT_TRUE(shown().empty());
}

TEST_F(StoppedPrograms, IgnoreDamagedAttachments) {
  begin("job.ngc");
  EXPECT_TRUE(session->flush());
  auto attachments = *read_attachments(session->journal_file());
  ASSERT_EQ(attachments.size(), 1U);
  attachments.front().bytes.pop_back();
  EXPECT_TRUE(stopped_programs(attachments, {}).empty());
}

TEST_F(SessionTest, ProgramsCannotFollowFailedOrUnknownOnes) {
  const auto session = start();
  const auto cancelled = session->programs().start(program_at({1}), {ProgramPace::kFeed})->id;
  session->programs().cancel(cancelled);
  const auto refused = [&](ProgramId after) {
    return !session->programs().start(program_at({1}), {.after = after});
  };
  EXPECT_TRUE(refused(cancelled));
  EXPECT_TRUE(refused(77));
  const auto finished = session->programs().start(program_at({}), {})->id;
  EXPECT_EQ(session->programs().start(program_at({1}), {.after = finished})->state,
            ProgramState::kRunning);
  const auto queued = session->programs().start(program_at({1}), {.after = kAfterNewest});
  EXPECT_EQ(queued->state, ProgramState::kQueued);
  EXPECT_EQ(queued->after, queued->id - 1);
}

}  // namespace
}  // namespace kerf::program_control_test
