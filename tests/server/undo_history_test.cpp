// SPDX-License-Identifier: Apache-2.0
// Random histories: strokes with every tool by several hands, alone and in parallel, undo, redo,
// branches, restarts with and without a snapshot, and looks back. After each step the block is
// compared with one carved from the surviving strokes alone.
#include "tests/server/rack_scene.h"
#include "tests/server/random_runs.h"
#include "tests/server/undo_fixture.h"
#include "tests/support/shuffled_workers.h"
#include "tests/support/test.h"

namespace kerf::undo_history_test {
namespace {

/// One of several schedules, switchable at any time.
class ChosenWorkers final : public Workers {
 public:
  void choose(std::size_t number) { chosen_ = all_[number % all_.size()]; }
  int count() const override { return chosen_->count(); }
  void run(int jobs, const std::function<void(int)>& job) override { chosen_->run(jobs, job); }

 private:
  SerialWorkers one_;
  test::ThreadWorkers two_{2}, five_{5};
  test::ShuffledWorkers shuffled_;
  std::array<Workers*, 4> all_{&one_, &two_, &five_, &shuffled_};
  Workers* chosen_ = &one_;
};

class RandomHistory : public SessionUndo {
 protected:
  void run(unsigned seed, int rounds) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    random_.seed(seed);
    carvers_ = &schedule_;
    schedule_.choose(one_of(4));
    snapshots_.writer = one_of(2) == 0 ? &writer_ : nullptr;
    snapshots_.limits = {.replay_time = {}, .age = std::chrono::hours(1), .pause = {}};
    renew();
    const char* rays = one_of(2) == 0 ? "dexel" : "tri-dexel";
    create(rack_scene(rays, one_of(8) == 0 ? "paper" : "tight"));
    join_hands();
    for (int round = 0; round < rounds; ++round) {
      SCOPED_TRACE("round " + std::to_string(round));
      step();
      ASSERT_EQ(hash(), never_happened());
      if (HasFailure()) return;
    }
    const std::uint64_t record = one_of(session_->sequence() + 1);
    EXPECT_EQ(session_->past().solid_at(record, schedule_).value().value().hash(),
              never_happened(record));
  }

 private:
  void step() {
    const auto kind = one_of(16);
    if (kind < 5) {
      carve({hands_[one_of(hands_.size())]});
    } else if (kind < 8) {
      carve(hands_);
    } else if (kind < 12) {
      change_some(true);
    } else if (kind < 14) {
      change_some(false);
    } else if (kind < 15) {
      writer_.run();
      reload();
      join_hands();
    } else {
      branch_off();
    }
  }

  void join_hands() {
    sequences_.clear();
    hands_ = {join("Ada"), join("Bo"), join("Cy")};
  }

  /// Carves a stroke of each hand in parallel, sample by sample.
  void carve(const std::vector<ParticipantId>& hands) {
    struct Line {
      Vec3 from, to;
      Vec3 axis_from, axis_to;
      std::uint32_t tool;
    };
    std::vector<Line> lines;
    for (std::size_t n = 0; n < hands.size(); ++n) {
      const Vec3 from{uniform(-18, 18), uniform(-18, 18), uniform(-6, 0)};
      const Vec3 axis = tilted();
      lines.push_back({from, from + Vec3{uniform(-8, 8), uniform(-8, 8), uniform(-2, 2)}, axis,
                       one_of(2) == 0 ? axis : tilted(),
                       1 + static_cast<std::uint32_t>(one_of(kRackTools))});
    }
    const int steps = 2 + static_cast<int>(one_of(10));
    for (int n = -2; n <= steps + 1; ++n) {
      const double share = std::clamp(double(n) / steps, 0.0, 1.0);
      const double lift = n == -2 || n == steps + 1 ? 30 : 0;
      std::vector<std::optional<MotionAnswer>> answers(hands.size());
      for (std::size_t hand = 0; hand < hands.size(); ++hand) {
        const Line& line = lines[hand];
        const Vec3 tip = line.from + (line.to - line.from) * share + Vec3{0, 0, lift};
        const Vec3 axis = normalized(line.axis_from + (line.axis_to - line.axis_from) * share);
        wire::MotionSample sample = next(hands[hand], tip, n > 0 && n <= steps);
        sample.axis = {float(axis.x), float(axis.y), float(axis.z)};
        sample.tool_id = line.tool;
        answers[hand] = session_->begin_move(hands[hand], {&sample, 1});
      }
      for (std::size_t hand = 0; hand < hands.size(); ++hand) {
        while (!answers[hand]) answers[hand] = session_->go_on(hands[hand]);
      }
    }
  }

  /// Undoes or redoes up to three eligible strokes.
  void change_some(bool undone) {
    std::vector<StrokeId> possible;
    const auto strokes = session_->past().strokes(0);
    for (const ListedStroke& listed : strokes.value()) {
      if (listed.is_undone != undone) possible.push_back(listed.stroke.id);
    }
    std::ranges::shuffle(possible, random_);
    possible.resize(std::min(possible.size(), 1 + one_of(3)));
    if (possible.empty()) return;
    schedule_.choose(one_of(4));
    const auto done = change({.undone = undone, .strokes = std::move(possible)});
    EXPECT_TRUE(done) << done.error().reason;
  }

  /// Continues in a branch from a random record. Deletes the original session.
  void branch_off() {
    const std::uint64_t record = one_of(session_->sequence() + 1);
    const std::uint64_t expected = never_happened(record);
    auto branch = test::value_of(registry_->branch("", *session_, record));
    const std::string left = session_->id();
    session_ = branch;
    EXPECT_EQ(hash(), expected);
    close(left);
    join_hands();
  }

  Vec3 tilted() { return normalized({uniform(-0.5, 0.5), uniform(-0.5, 0.5), 1}); }
  std::size_t one_of(std::size_t count) { return random_() % count; }
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 4294967296.0);
  }

  test::ManualExecutor writer_;
  ChosenWorkers schedule_;
  std::mt19937 random_;
  std::vector<ParticipantId> hands_;
};

TEST_F(RandomHistory, EqualsTheSurvivingSetToTheBit) {
  constexpr RandomRuns kHistories{.first_seed = 11, .count = 1, .rounds = 40};
  kHistories.each([this](unsigned seed, int rounds) { run(seed, rounds); });
}

TEST_F(SessionUndo, UndoAndRedoAreActivity) {
  create();
  const StrokeId only = stroke(join("Ada"), {-15, 0, -2}, {15, 0, -2});
  session_->note_times(1, 1);
  undo({only});
  EXPECT_GT(session_->figures().active_ms, 1);
  session_->note_times(1, 1);
  redo({only});
  EXPECT_GT(session_->figures().active_ms, 1);
}

}  // namespace
}  // namespace kerf::undo_history_test
