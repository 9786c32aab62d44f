// SPDX-License-Identifier: Apache-2.0
// Tools of other participants that end, are repeated, are many, or belong to a hostile server.
#include "haptic_agent/replica/other_tools.h"

#include <cmath>
#include <string>

#include "kernel/tool/tool_bounds.h"
#include "tests/agent/replica/intent_side.h"

namespace kerf::agent::other_tools_test {
namespace {

/// How a tool of another participant ends that has cut until the sample kEnd.
enum class End { kLeaves, kEmptyFrame, kSilent, kSilentLate, kOtherTool, kClockJump, kReset };
constexpr int kEnd = 150;

Vec3 along(int n) { return {-20 + 0.1 * n, 0, -2}; }

void add(wire::Intents& intents, const wire::Intent& intent) {
  intents.tools[intents.count++] = intent;
}

/// The frame of the sample n, after the end.
wire::Intents frame_after(End end, int n) {
  wire::Intents intents;
  wire::Intent tool = intent_of(n, {-5, 0, 3}, false);
  if (end == End::kLeaves) tool.participant = kOther + 1;  // a different tool stays near
  if (end == End::kSilent || end == End::kSilentLate) {
    tool = intent_of(kEnd, along(kEnd));
    tool.agent_time_us = time_of(n);
  }
  if (end == End::kOtherTool) tool.tool_id = 2;
  if (end == End::kClockJump) tool.time_us += 10'000'000;
  if (end != End::kEmptyFrame) add(intents, tool);
  return intents;
}

/// Returns the largest difference, N, from the force in a block cut by this agent alone, which
/// follows the other tool from the sample `begin` on.
double felt_of_ended(End end, int begin) {
  Side side;
  Sculpture alone = side.source.make();
  double off_n = 0, force_n = 0;
  Vec3 before;
  const int late = end == End::kSilentLate ? 50 : 0;
  for (int n = 0; n < begin + 300; ++n) {
    if (n == kEnd && end == End::kReset) {
      wire::StockPatch undone = all_tiles();
      undone.agent_time_us = time_of(n);
      EXPECT_TRUE(side.replica.take(undone));
    }
    if (n % kEvery == 0 && n >= late) {
      wire::Intents cutting;
      add(cutting, intent_of(n - late, along(n - late)));
      side.replica.take(n - late < kEnd ? cutting : frame_after(end, n));
    }
    const bool cuts = n >= begin;
    const Vec3 own{-15 + 0.05 * (n - begin), 0, cuts ? -2.0 : 5.0};
    const Vec3 felt_n = side.felt(n, own, cuts);
    if (n > begin) {
      const MoveTool move{1, {before, kUp}, {own, kUp}, 0.001, true};
      const Vec3 true_n = alone.apply(move).value().wrench.force_n;
      off_n = std::max(off_n, length(felt_n - true_n));
      force_n = std::max(force_n, length(true_n));
    }
    before = own;
  }
  EXPECT_GT(force_n, 3);
  return off_n;
}

TEST(OtherTools, WronglyExpectedCutsAreFeltAgainAfterTheToolEnds) {
  for (const End end :
       {End::kLeaves, End::kSilent, End::kSilentLate, End::kOtherTool, End::kClockJump}) {
    EXPECT_LT(felt_of_ended(end, kEnd + 200), 1e-3) << static_cast<int>(end);
  }
}

TEST(OtherTools, ToolMissingFromAFrameEndsAtOnce) {
  EXPECT_LT(felt_of_ended(End::kEmptyFrame, kEnd + 2), 1e-3);
  EXPECT_LT(felt_of_ended(End::kLeaves, kEnd + 2), 1e-3);
}

TEST(OtherTools, CutsUndoneByTheServerAreNotRepeated) {
  EXPECT_LT(felt_of_ended(End::kReset, kEnd + 2), 1e-3);
}

TEST(OtherTool, ARepeatedPoseDoesNotKeepItPresent) {
  OtherTool tool;
  for (int n = 0; n <= 300; n += kEvery) {
    wire::Intent same = intent_of(0, along(0));
    same.agent_time_us = time_of(n);
    tool.take(same, time_of(n));
    EXPECT_EQ(tool.is_present(time_of(n)), n < 100) << n;
  }
  tool.take(intent_of(310, along(310)), time_of(310));
  EXPECT_TRUE(tool.is_present(time_of(310)));
}

TEST(OtherTool, FloodOfPosesIsBounded) {
  OtherTool tool;
  wire::Intent pose = intent_of(0, along(0));
  for (int n = 0; n < 900; ++n, ++pose.time_us) tool.take(pose, time_of(0));
  EXPECT_EQ(tool.poses(), 1U) << "less than 1 ms apart";
  for (int n = 0; n < 900; ++n, pose.time_us += 1000) tool.take(pose, time_of(0));
  EXPECT_LE(tool.poses(), 64U);
  EXPECT_GE(tool.poses(), 16U);
}

/// Only the other tools, in a block whose middle is at this agent's tool.
struct Crowd {
  Crowd() : block(BlockSource::read(kWelcome)->make()), others(0.5) {}
  OtherTools::Own own(Vec3 tip_mm) const {
    return {tip_mm, tool_bounds(*block.tool(1), {tip_mm, kUp})};
  }
  /// Other tools, 2 mm deep, that move along y by 1 mm every 10 ms, at these x.
  void take(int n, std::initializer_list<double> xs) {
    wire::Intents intents;
    for (const double x : xs) {
      wire::Intent intent = intent_of(n, {x, 0.1 * n, -2});
      intent.participant = kOther + intents.count;
      add(intents, intent);
    }
    others.take(intents, time_of(n));
  }
  /// Returns whether the stock is gone at y = 1 and this x, 1 mm below the top.
  bool is_cut(double x) {
    const MoveTool touch{1, {{x, 0.5, -1}, kUp}, {{x, 1, -1}, kUp}, 0.001, true};
    Sculpture copy = BlockSource::read(kWelcome)->make();
    copy.restore(block.solid());
    return length(copy.apply(touch).value().wrench.force_n) == 0;
  }
  Sculpture block;
  OtherTools others;
};

TEST(OtherTools, OnlyTheFourNearestAreCut) {
  Crowd crowd;
  for (const int n : {0, 10, 20}) crowd.take(n, {-24, -16, 8, 16, 24, -8, 0});
  auto own = crowd.own({0, 0, 0});
  own.box = grown(own.box, 30);
  crowd.others.restart(time_of(20), own);
  crowd.others.cut(crowd.block, time_of(20));
  for (const double x : {0., -8., 8.}) EXPECT_TRUE(crowd.is_cut(x)) << x;
  EXPECT_NE(crowd.is_cut(-16), crowd.is_cut(16));
  for (const double x : {-24., 24.}) EXPECT_FALSE(crowd.is_cut(x)) << x;
  EXPECT_FALSE(crowd.others.are_off(time_of(20), own));
  own.tip_mm.x = 24;
  crowd.take(30, {-24, -16, 8, 16, 24, -8, 0});
  EXPECT_TRUE(crowd.others.are_off(time_of(30), own)) << "others are the nearest now";
}

TEST(OtherTools, AreCutOnlyAroundThisTool) {
  Crowd crowd;
  for (const int n : {0, 10, 20}) crowd.take(n, {20});
  crowd.others.restart(time_of(20), crowd.own({0, 0, 0}));
  crowd.others.cut(crowd.block, time_of(20));
  EXPECT_FALSE(crowd.is_cut(20));
  EXPECT_FALSE(crowd.others.are_off(time_of(20), crowd.own({2, 0, 0})));
  ASSERT_TRUE(crowd.others.are_off(time_of(20), crowd.own({14, 0, 0})));
  crowd.others.restart(time_of(20), crowd.own({14, 0, 0}));
  crowd.others.cut(crowd.block, time_of(20));
  EXPECT_TRUE(crowd.is_cut(20));
}

TEST(OtherTools, PathIsCutAgainIfOffByATenthOfThePitch) {
  for (const double off_mm : {0.045, 0.06}) {
    Crowd crowd;
    for (const int n : {0, 10, 20, 30, 40}) crowd.take(n, {0});
    const auto own = crowd.own({0, 4, 0});
    crowd.others.restart(time_of(40), own);
    for (int n = 40; n <= 54; ++n) crowd.others.cut(crowd.block, time_of(n));
    EXPECT_FALSE(crowd.others.are_off(time_of(54), own));
    crowd.take(50, {off_mm});
    EXPECT_EQ(crowd.others.are_off(time_of(50), own), off_mm > 0.05);
  }
}

}  // namespace
}  // namespace kerf::agent::other_tools_test
