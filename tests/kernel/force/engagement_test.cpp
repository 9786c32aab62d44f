// SPDX-License-Identifier: Apache-2.0
// Cut volume is delivered over the travel that follows: completely, evenly, and to the user that
// cut it.

#include "kernel/force/engagement.h"

#include "kernel/force/travel_queue.h"
#include "tests/support/test.h"

namespace kerf::engagement_test {
namespace {

constexpr double kWidth = 0.1;

CutSum volume(double mm3) {
  return {mm3, {mm3, 2 * mm3, 3 * mm3}, {-mm3, 0, mm3}, {0, 5 * mm3, 0}};
}

double step(TravelQueue& queue, double removed_mm3, double path_mm) {
  const double due = queue.advance(path_mm).volume_mm3;
  return due + queue.take(volume(removed_mm3), path_mm).volume_mm3;
}

TEST(TravelQueue, DeliversExactlyTheAddedAmount) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 200; ++round) {
    TravelQueue queue(kWidth);
    double in = 0, out = 0;
    for (int i = 0; i < 300; ++i) {
      // Ticks from zero to many widths; every other one cuts.
      const double path =
          random() % 5 == 0 ? 0 : std::pow(10.0, double(random() % 9000) / 1000 - 8);
      const double removed = random() % 2 == 0 ? double(random() % 1000) : 0;
      in += removed;
      const double due = step(queue, removed, path);
      EXPECT_GE(due, -1e-9 * in);
      out += due;
      ASSERT_NEAR(in, out + queue.pending().volume_mm3, 1e-12 * in + 1e-9);
    }
    out += queue.advance(2 * kWidth + 1e-9).volume_mm3;
    out += queue.advance(kWidth).volume_mm3;
    EXPECT_NEAR(out, in, 1e-9 * in);
    EXPECT_EQ(queue.pending().volume_mm3, 0);
    EXPECT_EQ(queue.advance(1).volume_mm3, 0);
  }
}

TEST(TravelQueue, PulsesEveryWidthOrFractionBecomeConstant) {
  for (const int pulses : {1, 2, 3}) {
    TravelQueue queue(kWidth);
    const double path = kWidth / (12 * pulses);  // one tick; every twelfth cuts
    for (int i = 0; i < 600; ++i) {
      const double due = step(queue, i % 12 == 0 ? 1 : 0, path);
      if (i <= 12 * 3 * pulses) continue;
      EXPECT_NEAR(due, 1.0 / 12, 0.02 / 12) << i;
    }
  }
}

TEST(TravelQueue, MeanDelayIsOneWidth) {
  TravelQueue queue(kWidth);
  queue.take(volume(1), 0);
  double moment = 0;
  for (int i = 0; i < 400; ++i) {
    moment += queue.advance(kWidth / 200).volume_mm3 * (i + 0.5) * kWidth / 200;
  }
  EXPECT_NEAR(moment, kWidth, 0.01 * kWidth);
}

TEST(TravelQueue, DoesNotDependOnTickLength) {
  const auto after = [](int ticks) {
    TravelQueue queue(kWidth);
    for (int i = 0; i < ticks; ++i) step(queue, 20 * 0.33 / ticks, 0.33 / ticks);
    return queue.advance(0.05).volume_mm3;
  };
  for (const int ticks : {3, 10, 100, 1000}) EXPECT_NEAR(after(ticks) / after(1), 1, 0.01) << ticks;
}

TEST(TravelQueue, ReportsTheEngagementAtRest) {
  TravelQueue queue(kWidth);
  for (int i = 0; i < 50; ++i) step(queue, 20 * 0.03, 0.03);
  EXPECT_NEAR(queue.due_per_mm().volume_mm3, 20, 0.4);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(step(queue, 0, 0), 0);
  EXPECT_NEAR(queue.due_per_mm().volume_mm3, 20, 0.4);
}

/// Returns the center of the engagement that a felt motion continues.
Vec3& center(Engagements& all, std::uint32_t tool, const ToolPose& from, const ToolPose& to) {
  return all.follow(tool, from, to, true).engagement->center_mm;
}

TEST(Engagements, ContinueByToolAndPose) {
  Engagements all(kWidth);
  const ToolPose a{{0, 0, 0}}, b{{1, 0, 0}}, c{{2, 0, 0}}, d{{3, 0, 0}};
  center(all, 1, a, b) = {7, 0, 0};
  center(all, 1, c, d) = {8, 0, 0};         // another user of the same tool
  EXPECT_EQ(center(all, 1, b, a).x, 7);     // the first user continues
  EXPECT_EQ(center(all, 1, d, c).x, 8);     // and the second
  EXPECT_EQ(center(all, 2, a, b), Vec3{});  // another tool at the same pose
  EXPECT_EQ(center(all, 1, b, c), Vec3{});  // no motion ended here
}

TEST(Engagements, ContinueUnfeltMotionsWithoutPendingForce) {
  Engagements all(kWidth);
  const ToolPose a{{0, 0, 0}}, b{{1, 0, 0}}, c{{2, 0, 0}};
  EXPECT_FALSE(all.follow(1, a, b, true).continues);
  center(all, 1, b, a) = {7, 0, 0};
  const auto unfelt = all.follow(1, a, c, false);
  EXPECT_TRUE(unfelt.continues);
  EXPECT_EQ(unfelt.engagement->center_mm, Vec3{});
  const auto felt = all.follow(1, c, a, true);
  EXPECT_TRUE(felt.continues);
  EXPECT_EQ(felt.engagement->center_mm, Vec3{});
  EXPECT_FALSE(all.follow(2, a, b, true).continues);
  EXPECT_FALSE(all.follow(1, c, b, true).continues);
}

TEST(Engagements, AreDroppedWhenAToolIsRedefined) {
  Engagements all(kWidth);
  const ToolPose a{{0, 0, 0}}, b{{1, 0, 0}};
  center(all, 1, a, b) = {7, 0, 0};
  center(all, 2, a, b) = {8, 0, 0};
  all.forget(1);
  EXPECT_EQ(center(all, 1, b, a), Vec3{});
  EXPECT_EQ(center(all, 2, b, a).x, 8);
}

TEST(Engagements, DropTheLeastRecentlyMovedUser) {
  Engagements all(kWidth);
  const auto at = [](double x) { return ToolPose{{x, 0, 0}}; };
  for (int i = 0; i < 300; ++i) center(all, 1, at(i), at(i + 0.5)) = {7, 0, 0};
  EXPECT_EQ(center(all, 1, at(0.5), at(0.6)), Vec3{});
  EXPECT_EQ(center(all, 1, at(299.5), at(299.6)).x, 7);
}

}  // namespace
}  // namespace kerf::engagement_test
