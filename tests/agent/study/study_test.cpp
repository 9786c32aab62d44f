// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/study/study.h"

#include <sys/resource.h>
#include <unistd.h>

#include <csignal>

#include "tests/support/eventually.h"
#include "tests/support/test.h"

namespace kerf::agent::study_test {
namespace {

using State = TrialRun::State;

TickRecord cutting_tick(std::uint64_t n, ForceMode mode) {
  return {.time_us = n * 1000,
          .computed = {{2, 0, 0}, {}},
          .felt = {{mode == ForceMode::kModel ? 2.0 : 1.0, 0, 0}, {}},
          .phase = ServoPhase::kActive,
          .mode = mode,
          .has_pose = true};
}

/// Runs to the next question. Returns the modes in which both intervals were rendered.
std::vector<ForceMode> run_to_question(TrialRun& run, std::uint64_t& n) {
  std::vector<ForceMode> modes;
  // A trial needs some thousand ticks.
  for (int tick = 0; run.state() != State::kQuestion; ++tick) {
    if (tick == 100'000) {
      ADD_FAILURE() << "no question";
      break;
    }
    const State before = run.state();
    run.take(cutting_tick(++n, run.mode()));
    if (run.state() != before && (run.state() == State::kA || run.state() == State::kB)) {
      modes.push_back(run.mode());
    }
  }
  return modes;
}

TEST(TrialRun, EachTrialHasBothLoopsAndSilenceOtherwise) {
  TrialRun run({.trials = 10, .seed = 3, .interval_ticks = 100});
  std::uint64_t n = 0;
  int kerf_first = 0;
  for (int trial = 1; trial <= 10; ++trial) {
    EXPECT_EQ(run.trial(), trial);
    EXPECT_EQ(run.mode(), ForceMode::kSilent) << "before an interval";
    const auto modes = run_to_question(run, n);
    ASSERT_EQ(modes.size(), 2U);
    EXPECT_NE(modes[0], modes[1]);
    EXPECT_EQ(run.mode(), ForceMode::kSilent) << "during the question";
    kerf_first += modes[0] == ForceMode::kModel ? 1 : 0;
    const auto result = test::value_of(run.answer(1, n * 1000 + 1'500'000));
    EXPECT_EQ(result.intervals[0].mode, modes[0]);
    EXPECT_EQ(result.correct(), modes[1] == ForceMode::kModel);
    EXPECT_DOUBLE_EQ(result.reaction_s, 1.5);
    for (const Interval& interval : result.intervals) {
      EXPECT_EQ(interval.felt.ticks, 100U);
      EXPECT_DOUBLE_EQ(interval.felt.force.error(), interval.mode == ForceMode::kModel ? 0 : 0.5);
    }
  }
  EXPECT_EQ(run.state(), State::kDone);
  EXPECT_EQ(run.answer(0, 0), std::nullopt);
  EXPECT_GT(kerf_first, 1);
  EXPECT_LT(kerf_first, 9);
}

TEST(TrialRun, SeedDecidesTheOrder) {
  const auto orders = [](std::uint64_t seed) {
    TrialRun run({.trials = 30, .seed = seed, .interval_ticks = 1});
    std::uint64_t n = 0;
    std::vector<ForceMode> first;
    for (int trial = 0; trial < 30; ++trial) {
      first.push_back(run_to_question(run, n).front());
      run.answer(0, 0);
    }
    return first;
  };
  EXPECT_EQ(orders(7), orders(7));
  EXPECT_NE(orders(7), orders(8));
}

TEST(TrialRun, OnlyTicksWithAForceInTheIntervalsModeCount) {
  TrialRun run({.trials = 1, .seed = 1, .interval_ticks = 10});
  std::uint64_t n = 0;
  while (run.state() != State::kA) run.take(cutting_tick(++n, ForceMode::kSilent));
  TickRecord unarmed = cutting_tick(++n, run.mode());
  unarmed.phase = ServoPhase::kReady;
  for (int i = 0; i < 100; ++i) run.take(unarmed);
  for (int i = 0; i < 100; ++i) run.take(cutting_tick(++n, ForceMode::kSilent));
  EXPECT_EQ(run.state(), State::kA);
  for (int i = 0; i < 10; ++i) run.take(cutting_tick(++n, run.mode()));
  EXPECT_EQ(run.state(), State::kBetween);
  EXPECT_EQ(run.answer(0, 0), std::nullopt) << "nothing has been asked";
}

TEST(Study, ChanceFollowsTheBinomialDistribution) {
  EXPECT_NEAR(chance_of(0, 20), 1, 1e-12);
  EXPECT_NEAR(chance_of(20, 20), std::pow(0.5, 20), 1e-18);
  EXPECT_NEAR(chance_of(15, 20), 0.020695, 1e-6) << "as tables of the sign test have it";
}

/// Simulates servo and user: ticks in the mode that the study sets, and an answer to each question.
TEST(Study, WritesALineAfterEachAnswer) {
  const auto file = std::filesystem::path(testing::TempDir()) / "study_test.csv";
  std::filesystem::remove(file);
  int keys[2] = {};
  ASSERT_EQ(::pipe(keys), 0);
  constexpr int kTrials = 3;
  auto study = test::value_of(
      Study::create(file.string(), {.trials = kTrials, .seed = 5, .interval_ticks = 50}, keys[0]));
  EXPECT_FALSE(Study::create(file.string(), {}, keys[0])) << "no table is overwritten";
  std::atomic<ForceMode> mode{ForceMode::kSilent};
  std::atomic<bool> done{false};
  std::atomic<int> questions{0};
  study->start({.set_mode = [&](ForceMode next) { mode.store(next); },
                .say =
                    [&](const std::string& text) {
                      if (text.ends_with("a or b?")) ++questions;
                    },
                .done = [&] { done.store(true); }});
  int answered = 0;
  // Its 3 trials of 2 x 500 + 2 x 50 ticks take some seconds. The bound only ends a failed test.
  for (std::uint64_t n = 1; !done.load() && n < 1'000'000; ++n) {
    study->tape().push(cutting_tick(n, mode.load()));
    if (questions.load() > answered) {
      ++answered;
      ASSERT_EQ(::write(keys[1], "xb\n", 3), 3) << "other keys are ignored";
    }
    std::this_thread::sleep_for(std::chrono::microseconds(50));
  }
  const StudyReport report = study->finish();
  EXPECT_EQ(report.answered, kTrials);
  std::ifstream in(file);
  std::string line;
  std::vector<std::string> lines;
  while (std::getline(in, line)) lines.push_back(line);
  ASSERT_EQ(lines.size(), 1U + kTrials);
  EXPECT_EQ(lines[0] + "\n", study_header());
  int correct = 0;
  for (int i = 1; i <= kTrials; ++i) {
    const std::string& row = lines[static_cast<std::size_t>(i)];
    const bool kerf_second = row.find(",paper-kerf,paper,kerf,B,1,") != std::string::npos;
    const bool kerf_first = row.find(",kerf-paper,kerf,paper,B,0,") != std::string::npos;
    EXPECT_TRUE(kerf_second || kerf_first) << row;
    EXPECT_TRUE(row.starts_with(std::to_string(i) + ",5,")) << row;
    EXPECT_TRUE(row.ends_with(",50,50")) << row;
    correct += kerf_second ? 1 : 0;
  }
  EXPECT_EQ(report.correct, correct);
  ::close(keys[0]);
  ::close(keys[1]);
}

TEST(Study, EndsWhenTheKeyboardIsClosed) {
  const auto file = std::filesystem::path(testing::TempDir()) / "study_closed.csv";
  std::filesystem::remove(file);
  int keys[2] = {};
  ASSERT_EQ(::pipe(keys), 0);
  auto study = test::value_of(Study::create(file.string(), {}, keys[0]));
  std::atomic<bool> done{false};
  study->start({.set_mode = [](ForceMode) {},
                .say = [](const std::string&) {},
                .done = [&] { done.store(true); }});
  ::close(keys[1]);
  EXPECT_TRUE(test::eventually([&done] { return done.load(); }));
  EXPECT_EQ(study->finish().answered, 0);
  ::close(keys[0]);
}

TEST(Study, UnwritableTableIsReported) {
  const auto file = std::filesystem::path(testing::TempDir()) / "study_full.csv";
  std::filesystem::remove(file);
  int keys[2] = {};
  ASSERT_EQ(::pipe(keys), 0);
  auto study = test::value_of(
      Study::create(file.string(), {.trials = 1, .seed = 5, .interval_ticks = 5}, keys[0]));
  // A limit of the file's size simulates a full disk: the write fails likewise.
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{.rlim_cur = study_header().size(), .rlim_max = before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  std::atomic<ForceMode> mode{ForceMode::kSilent};
  std::atomic<bool> done{false}, asked{false};
  study->start({.set_mode = [&](ForceMode next) { mode.store(next); },
                .say = [&](const std::string& text) { asked = text.ends_with("a or b?"); },
                .done = [&] { done.store(true); }});
  for (std::uint64_t n = 1; !asked.load() && n < 1'000'000; ++n) {
    study->tape().push(cutting_tick(n, mode.load()));
    std::this_thread::sleep_for(std::chrono::microseconds(50));
  }
  ASSERT_EQ(::write(keys[1], "a", 1), 1);
  EXPECT_TRUE(test::eventually([&done] { return done.load(); }));
  const StudyReport report = study->finish();
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(report.error, "cannot write " + file.string());
  EXPECT_TRUE(study_text(report).ends_with(": " + report.error)) << study_text(report);
  ::close(keys[0]);
  ::close(keys[1]);
}

TEST(Study, PrintsSmallProbabilitiesInPlainDecimals) {
  const std::string text =
      study_text({.file = "s.csv", .answered = 20, .correct = 19, .error = {}});
  EXPECT_NE(text.find("in 0.002 % of"), std::string::npos) << text;
  const std::string all =
      study_text({.file = "s.csv", .answered = 1000, .correct = 1000, .error = {}});
  EXPECT_NE(all.find("in less than 0.001 % of"), std::string::npos) << all;
}

}  // namespace
}  // namespace kerf::agent::study_test
