// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "tests/server/undo_fixture.h"

namespace kerf {
namespace {

/// Strokes, undo, redo and restarts at random, each followed by a comparison.
class RandomHistory : public SessionUndo {
 protected:
  void run(unsigned seed, const char* rays) {
    random_.seed(seed);
    done_.clear();
    undone_.clear();
    std::string scene = kScene;
    scene.replace(scene.find("\"dexel\""), 7, rays);
    create(scene);
    join_hands();
    for (int round = 0; round < 60; ++round) {
      step();
      ASSERT_EQ(hash(), never_happened()) << "seed " << seed << " round " << round;
    }
  }

 private:
  void step() {
    const auto kind = random_() % 8;
    if (kind < 4 || (done_.empty() && undone_.empty())) {
      const Vec3 from{uniform(-18, 18), uniform(-18, 18), uniform(-6, 0)};
      const Vec3 to = from + Vec3{uniform(-10, 10), uniform(-10, 10), uniform(-2, 2)};
      const ParticipantId hand = hands_[random_() % hands_.size()];
      done_.push_back(stroke(hand, from, to, 3 + static_cast<int>(random_() % 20)));
    } else if (kind < 6 && !done_.empty()) {
      undo(shift(done_, undone_));
    } else if (kind < 7 && !undone_.empty()) {
      redo(shift(undone_, done_));
    } else {
      reload();
      sequences_.clear();
      join_hands();
    }
  }
  void join_hands() { hands_ = {join("Ada"), join("Bo"), join("Cy")}; }
  std::vector<StrokeId> shift(std::vector<StrokeId>& from, std::vector<StrokeId>& to) {
    std::vector<StrokeId> some;
    for (std::size_t n = 1 + random_() % 3; n > 0 && !from.empty(); --n) {
      const auto at = from.begin() + static_cast<std::ptrdiff_t>(random_() % from.size());
      some.push_back(*at);
      to.push_back(*at);
      from.erase(at);
    }
    return some;
  }
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 4294967296.0);
  }

  std::mt19937 random_;
  std::vector<ParticipantId> hands_;
  std::vector<StrokeId> done_, undone_;
};

TEST_F(RandomHistory, EqualsTheSurvivingSetToTheBit) {
  // KERF_EFFORT multiplies the histories, KERF_SEED is the first seed; gtest's --gtest_repeat does
  // not change the seed.
  const auto setting = [](const char* name, unsigned otherwise) {
    const char* text = std::getenv(name);
    return text == nullptr ? otherwise : static_cast<unsigned>(std::atoi(text));
  };
  const unsigned first = setting("KERF_SEED", 11), histories = setting("KERF_EFFORT", 1);
  for (unsigned seed = first; seed < first + histories; ++seed) {
    if (seed > first) renew();
    run(seed, seed % 2 == 1 ? "\"tri-dexel\"" : "\"dexel\"");
    if (HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace kerf
