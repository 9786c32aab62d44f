// SPDX-License-Identifier: Apache-2.0
// The expected path of another participant's tool, and the force in a block without its expected
// cuts.
#include "haptic_agent/replica/other_tool.h"

#include "haptic_agent/replica/replica_thread.h"
#include "kernel/dexel/dexel_field.h"
#include "server/wire/codec.h"
#include "tests/agent/replica/intent_side.h"
#include "tests/support/test.h"

namespace kerf::agent::other_tool_test {
namespace {

Vec3 circle(int n) { return {8 * std::cos(0.005 * n), 8 * std::sin(0.005 * n), -2}; }
Vec3 line(int n) { return {-15 + 0.03 * n, 2, -2}; }
Vec3 parabola(int n) { return {-15 + 0.03 * n - 0.00002 * n * n, 2, -2}; }

TEST(OtherTool, IsExpectedOnItsLineAndCircle) {
  for (const auto path : {circle, line, parabola}) {
    OtherTool tool;
    for (int n = 0; n <= 200; n += kEvery) tool.take(intent_of(n, path(n)), time_of(n + kLate));
    for (const int ahead : {0, 30, kLate}) {
      const Vec3 off = tool.at(time_of(200 + ahead)).tip_mm - path(200 + ahead);
      EXPECT_LT(length(off), 0.15) << ahead << " ms";
    }
  }
}

TEST(OtherTool, IsGoneWithoutPoses) {
  OtherTool tool;
  EXPECT_FALSE(tool.is_present(time_of(0)));
  tool.take(intent_of(0, line(0)), time_of(kLate));
  EXPECT_TRUE(tool.is_present(time_of(kLate + 50)));
  EXPECT_FALSE(tool.is_present(time_of(kLate + 150)));
}

/// Returns the rms error of the force over its rms, with or without the other tool's poses.
/// `twice`: each frame lists the other tool a second time, with an unknown tool.
double error_beside_another(bool intent, bool twice = false) {
  Side side;
  double error2 = 0, force2 = 0;
  for (int n = 0; n < 700; ++n) {
    const Vec3 own = line(n) + Vec3{0, -2, 0}, other = line(n + 50);
    const Vec3 force_n = side.cut(own, other);
    if (intent && n % kEvery == 0 && n >= kLate) {
      wire::Intents intents{.count = 1};
      intents.tools[0] = intent_of(n - kLate, line(n - kLate + 50));
      if (twice) {
        intents.tools[intents.count] = intents.tools[0];
        intents.tools[intents.count++].tool_id = 99;
      }
      side.replica.take(intents);
    }
    const Vec3 felt_n = side.felt(n, own);
    if (n < 300) continue;
    error2 += dot(felt_n - force_n, felt_n - force_n);
    force2 += dot(force_n, force_n);
  }
  return std::sqrt(error2 / force2);
}

/// The solid lengths of all columns together, in quanta.
std::int64_t solid_quanta(const Sculpture& block) {
  const DexelField& field = *block.field(RayAxis::kZ);
  std::int64_t sum = 0;
  std::vector<Dexel> column;
  for (std::int32_t y = 0; y < 4; ++y) {
    for (std::int32_t x = 0; x < 4; ++x) {
      const auto tile = field.fresh({x, y});
      for (int n = 0; n < kTileColumns; ++n) {
        tile->read(n, column);
        for (const Dexel& solid : column) sum += solid.top - solid.bottom;
      }
    }
  }
  return sum;
}

TEST(ReplicaIntent, ForceAccountsForTheCutsOfAnotherTool) {
  EXPECT_LT(error_beside_another(true), 0.05);
  EXPECT_GT(error_beside_another(false), 0.3);
}

TEST(ReplicaIntent, FirstPoseOfADuplicateParticipantCounts) {
  EXPECT_LT(error_beside_another(true, true), 0.05);
}

TEST(ReplicaIntent, StockLeftByTheOtherToolIsFelt) {
  // The other tool stops in front of this agent's tool, which continues into the stock behind it.
  Side side;
  Sculpture own_cuts = side.source.make();
  double error_n = 0, force_n = 0;
  for (int n = 0; n < 900; ++n) {
    const Vec3 own = line(n) + Vec3{0, -2, 0};
    const auto path = [](int at) { return line(std::min(at + 100, 400)) + Vec3{0, -1, 0}; };
    const Vec3 expected_n = side.cut(own, path(n));
    if (n > 0) {
      const Vec3 before = line(n - 1) + Vec3{0, -2, 0};
      own_cuts.apply(MoveTool{1, {before, kUp}, {own, kUp}, 0.001, false}).value();
    }
    if (n % kEvery == 0 && n >= kLate) {
      wire::Intents intents{.count = 1};
      intents.tools[0] = intent_of(n - kLate, path(n - kLate), n - kLate < 300);
      side.replica.take(intents);
    }
    const Vec3 felt_n = side.felt(n, own);
    if (n < 440) continue;
    error_n = std::max(error_n, length(felt_n - expected_n));
    force_n = std::max(force_n, length(expected_n));
  }
  EXPECT_GT(force_n, 3);
  EXPECT_LT(error_n, 0.1 * force_n);
  // The cuts of the other tool never enter the replica itself: the server's tiles would bring them.
  EXPECT_EQ(solid_quanta(side.replica.block()), solid_quanta(own_cuts));
}

TEST(ReplicaIntent, AbsurdPosesAreIgnored) {
  Side side;
  for (int n = 0; n < 300; ++n) {
    wire::Intents intents{.count = 2};
    intents.tools[0] = intent_of(n, {n % 2 == 0 ? -1e9 : 1e9, 0, 0});
    intents.tools[0].agent_time_us = n % 3 == 0 ? UINT64_MAX : 0;
    intents.tools[1] = intent_of(n, line(n));
    intents.tools[1].participant = static_cast<std::uint32_t>(n);
    intents.tools[1].tool_id = 99;
    intents.tools[1].time_us = n % 5 == 0 ? UINT64_MAX - 1 : static_cast<std::uint64_t>(n);
    side.replica.take(intents);
    const Vec3 own = line(n);
    const Vec3 force_n = side.cut(own, {0, 0, 90});
    if (n >= 20) {
      EXPECT_LT(length(side.felt(n, own) - force_n), 1e-3) << n;
    } else {
      side.felt(n, own);
    }
  }
}

TEST(ReplicaThread, PassesStockAndIntentFramesToTheReplica) {
  ReplicaExchange servo;
  ReplicaThread thread(servo);
  const auto pass = [&](const auto& body) {
    std::vector<std::byte> frame;
    wire::append(frame, {.epoch = 1, .sequence = 1, .time_us = 0}, body);
    thread.take_stock(frame);
  };
  wire::Intents intents{.count = 1};
  intents.tools[0] = intent_of(0, line(0));
  pass(all_tiles());
  pass(intents);
  pass(wire::Ping{1});
  thread.start(*BlockSource::read(kWelcome));
  ServerWrench answer;
  for (int n = 0; n < 1'000'000 && !servo.read(answer); ++n) {
    wire::MotionSample sample{.agent_sequence = static_cast<std::uint64_t>(n + 1),
                              .time_us = time_of(n),
                              .tip_mm = line(n % 100),
                              .tool_id = 1};
    servo.push(sample);
    servo.wake();
    std::this_thread::yield();
  }
  thread.stop();
  EXPECT_EQ(thread.report().patches, 1U);
  EXPECT_EQ(thread.report().intents, 1U);
  EXPECT_EQ(thread.report().bad_patches, 1U) << "a ping is neither";
}

}  // namespace
}  // namespace kerf::agent::other_tool_test
