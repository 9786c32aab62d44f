// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/cut_coupling.h"

#include "tests/support/test.h"

namespace kerf::agent::cut_coupling_test {
namespace {

constexpr double kTickS = 0.001;
constexpr double kPi = std::numbers::pi;
const Vec3 kArm{0, 0, -60};

/// Returns the mean share of the power of a force that leads the trembling by `lead_rad`.
double driven(double hz, double mm_per_s, double lead_rad) {
  Trembling trembling;
  double sum = 0;
  for (int i = 0; i < 2000; ++i) {
    const double angle = 2 * kPi * hz * kTickS * i;
    trembling.take({std::cos(angle + lead_rad), 0, 0}, {mm_per_s * kTickS * std::cos(angle), 0, 0},
                   kTickS);
    if (i >= 1000) sum += trembling.driven() / 1000;
  }
  return sum;
}

TEST(Trembling, IsDrivenByTheCosineOfTheForcesPhase) {
  for (const double hz : {20.0, 50.0, 125.0}) {
    for (int eighth = 0; eighth < 8; ++eighth) {
      EXPECT_NEAR(driven(hz, 30, eighth * kPi / 4), std::cos(eighth * kPi / 4), 0.02) << hz;
    }
  }
}

TEST(Trembling, NeitherVoluntaryNorTinyMotionCounts) {
  EXPECT_LT(driven(1, 30, 0), 0.15) << "a hand that swings once per second";
  EXPECT_LT(driven(50, 0.1, 0), 0.15) << "noise of an encoder";
}

/// A device; with a latency of 0, `force_delay_s` is one tick.
ContactLimits pen(double inertia_kg_m2, double latency_s = 0) {
  return {.mass_kg = 0.1,
          .inertia_kg_m2 = inertia_kg_m2,
          .force_delay_s = latency_s + 0.001,
          .velocity_delay_s = latency_s + 0.003};
}

/// A tool that moves along x at 30 mm/s and trembles along y, with a cut of 1.5 N that turns with
/// the tremor, against it at once or after a delay.
struct Cutting {
  explicit Cutting(const ContactLimits& limits) : coupling(limits) {}

  /// Trembles with a speed that doubles in `doubles_s`, up to 20 mm/s.
  void tremble(int ticks, double late_s, double doubles_s = 0.02) {
    for (int i = 0; i < ticks; ++i) {
      const auto velocity = [this](double at_s) {
        return Vec3{30, mm_per_s * std::cos(2 * kPi * 50 * at_s), 0};
      };
      time_s += kTickS;
      mm_per_s = std::min(20.0, mm_per_s * std::exp2(kTickS / doubles_s));
      move(velocity(time_s) * kTickS, velocity(time_s - late_s));
    }
  }
  void move(Vec3 step, Vec3 against) {
    now.grip.pivot_mm = now.grip.pivot_mm + step;
    const Vec3 force = against * (-1.5 / length(against));
    computed = {force, cross(kArm, force)};
    felt = coupling.at(computed, kArm, now, kTickS);
    most_computed_n = std::max(most_computed_n, std::abs(computed.force_n.y));
    most_felt_n = std::max(most_felt_n, std::abs(felt.force_n.y));
  }

  CutCoupling coupling;
  PastGrip now{};
  Wrench computed, felt;
  double time_s = 0, mm_per_s = 0.02, most_computed_n = 0, most_felt_n = 0;
};

TEST(CutCoupling, WithoutTremblingTheForceIsTheComputedOne) {
  Cutting tool(pen(1e-5));
  for (int i = 0; i < 3000; ++i) {
    const double angle = i / 1000 * kPi / 2 + 0.002 * (i % 1000);  // arcs with sharp corners
    const Vec3 velocity{30 * std::cos(angle), 30 * std::sin(angle), 0};
    tool.move(velocity * kTickS, velocity);
    EXPECT_EQ(tool.felt, tool.computed);
  }
}

TEST(CutCoupling, WeakForceAtACornerIsNotDriving) {
  // A plunge that ends, with 0.1 N along it for some more ticks, and a cut across it.
  CutCoupling coupling(pen(2e-4), 4);
  PastGrip now{};
  const auto move = [&](Vec3 mm_per_s, Vec3 force) {
    now.grip.pivot_mm = now.grip.pivot_mm + mm_per_s * kTickS;
    coupling.at({force, cross(kArm, force)}, kArm, now, kTickS);
  };
  for (int i = 0; i < 30; ++i) move({0, 0, -55}, {0, 0, i < 29 ? 0.0 : 0.02});
  for (int i = 0; i < 3; ++i) move({0, 55, 0}, {0, -0.05 * i, 0.1});
  for (int i = 0; i < 20; ++i) move({0, 55, 0}, {0, -0.2 * i, 0.02});
  EXPECT_LT(coupling.compliance_mm_per_n(), 0.1);
}

TEST(CutCoupling, OnsetOfAStrokeIsNotTrembling) {
  // Pecks at 3 Hz, 2 mm deep, along the axis. The force begins and ends one tick late while the
  // tool moves fast.
  CutCoupling coupling(pen(2e-4), 4);
  PastGrip now{};
  double force_n = 0;
  for (int i = 0; i < 2000; ++i) {
    const double phase = 2 * kPi * 3 * kTickS * i;
    const double mm_per_s = -1.5 * 2 * kPi * 3 * std::sin(phase);
    now.grip.pivot_mm.z += mm_per_s * kTickS;
    now.velocity.linear = {0, 0, mm_per_s};
    const Wrench computed{{0, 0, force_n}, {}};
    EXPECT_EQ(coupling.at(computed, kArm, now, kTickS), computed) << i;
    force_n = mm_per_s < 0 && now.grip.pivot_mm.z < -1 ? 2 : 0;
  }
  EXPECT_EQ(coupling.compliance_mm_per_n(), 0);
}

TEST(CutCoupling, ForceThatBrakesTheTremblingIsTheComputedOne) {
  Cutting tool(pen(1e-5));
  for (const double late_s : {0.0, 0.001, 0.002}) {
    tool.tremble(1000, late_s);
    EXPECT_EQ(tool.felt, tool.computed) << late_s;
  }
}

TEST(CutCoupling, ForceThatDrivesTheTremblingFollowsItSoftly) {
  Cutting tool(pen(1e-5, 0.003));
  tool.tremble(200, 0.006);
  tool.most_computed_n = tool.most_felt_n = 0;
  tool.tremble(20, 0.006);
  EXPECT_GT(tool.most_computed_n, 0.7);
  EXPECT_LT(tool.most_felt_n, 0.1 * tool.most_computed_n);
  EXPECT_NEAR(tool.felt.torque_nmm.x, cross(kArm, tool.felt.force_n).x, 1e-9) << "one wrench";
  EXPECT_NEAR(tool.felt.torque_nmm.y, cross(kArm, tool.felt.force_n).y, 1e-9);
}

TEST(CutCoupling, FadingTremblingDoesNotSoftenTheForce) {
  Cutting tool(pen(1e-5, 0.003));
  tool.tremble(200, 0.006);
  double compliance = tool.coupling.compliance_mm_per_n();
  EXPECT_GT(compliance, 0.1);
  tool.tremble(30, 0.006, -0.02);  // growth is measured over a few hundredths of a second
  compliance = tool.coupling.compliance_mm_per_n();
  tool.tremble(100, 0.006, -0.02);
  EXPECT_LT(tool.coupling.compliance_mm_per_n(), compliance);
}

TEST(CutCoupling, ForceIsJudgedWhenItActs) {
  Cutting prompt(pen(1e-5)), late(pen(1e-5, 0.009));
  prompt.tremble(250, 0);
  late.tremble(250, 0);
  EXPECT_EQ(prompt.coupling.compliance_mm_per_n(), 0);
  EXPECT_GT(late.coupling.compliance_mm_per_n(), 1) << "half a period late, it drives";
}

TEST(CutCoupling, IsNoSofterThanTheDeviceAloneRequires) {
  for (const double inertia : {1e-5, 2e-4}) {
    Cutting tool(pen(inertia, 0.003));
    tool.tremble(250, 0.006);
    const double softest = 3 / gains_across(pen(inertia, 0.003), kArm).stiffness;
    EXPECT_LE(tool.coupling.compliance_mm_per_n(), softest);
    EXPECT_GT(tool.coupling.compliance_mm_per_n(), 0.5 * softest);
  }
}

TEST(CutCoupling, MayBeAsSoftAsTheCutRequires) {
  const double stable = 3 / gains_across(pen(2e-4), kArm).stiffness;
  Cutting tool(pen(2e-4));
  tool.coupling = CutCoupling(pen(2e-4), 3 * stable);
  tool.tremble(250, 0.006);
  EXPECT_GT(tool.coupling.compliance_mm_per_n(), 1.5 * stable);
  EXPECT_LE(tool.coupling.compliance_mm_per_n(), 3 * stable);
}

TEST(CutCoupling, BecomesStiffAgainAfterTheTrembling) {
  Cutting tool(pen(2e-4, 0.003));
  tool.tremble(500, 0.006);
  EXPECT_GT(tool.coupling.compliance_mm_per_n(), 0.5);
  for (int i = 0; i < 3000; ++i) tool.move({0.03, 0, 0}, {1, 0, 0});
  EXPECT_LT(tool.coupling.compliance_mm_per_n(), 0.02);
  EXPECT_NEAR(tool.felt.force_n.x, -1.5, 1e-3);
}

TEST(CutCoupling, NextCutForgetsTheLastDirection) {
  Cutting tool(pen(2e-4, 0.003));
  tool.tremble(500, 0.006);
  tool.coupling.release(kArm, tool.now, kTickS);
  tool.move({0, 0.03, 0}, {0, 1, 0});
  EXPECT_LT(tool.felt.force_n.y, 0);
  EXPECT_NEAR(tool.felt.force_n.x, 0, 1e-12);
}

/// A tool in a cut of 1.5 N along x, whose coupling trembling has made soft.
struct Held : Cutting {
  Held() : Cutting(pen(1e-5, 0.003)) {
    tremble(500, 0.006);
    for (int i = 0; i < 100; ++i) move({0.03, 0, 0}, {1, 0, 0});
    loaded_n = -felt.force_n.x;
  }
  /// Moves along x where no stock is left. Returns the force against the motion.
  double retrace(double speed_mm_per_s, int ticks, Vec3 force_n = {}) {
    for (int i = 0; i < ticks; ++i) {
      now.grip.pivot_mm.x += speed_mm_per_s * kTickS;
      now.velocity.linear = {speed_mm_per_s, 0, 0};
      felt = coupling.at({force_n, cross(kArm, force_n)}, kArm, now, kTickS);
    }
    return -felt.force_n.x;
  }

  double loaded_n = 0;
};

TEST(CutCoupling, HoldsAToolThatReversedInItsCut) {
  Held tool;
  ASSERT_GT(tool.loaded_n, 0.1) << "the test requires a force";
  const double c = tool.coupling.compliance_mm_per_n();
  const double damped_n = 2 * gains_across(pen(1e-5, 0.003), kArm).damping;
  EXPECT_NEAR(tool.retrace(-2, 200), tool.loaded_n - 0.4 / c - damped_n, 1e-3);
  EXPECT_NEAR(tool.retrace(2, 190), tool.loaded_n - 0.02 / c + damped_n, 1e-3)
      << "the force returns with the place";
  EXPECT_GT(tool.coupling.compliance_mm_per_n(), 0.99 * c) << "a stiffer one would tremble again";
}

TEST(CutCoupling, DampsAHeldTool) {
  Held slow, fast;
  const double c = slow.coupling.compliance_mm_per_n();
  const double difference_n = slow.retrace(-1, 1) - fast.retrace(-20, 1);
  EXPECT_GT(difference_n - 0.019 / c, 5 * gains_across(pen(1e-5, 0.003), kArm).damping);
}

TEST(CutCoupling, ReleasesAToolAtTheEndOfItsCut) {
  Held tool;
  tool.retrace(-2, 200);
  EXPECT_NEAR(tool.retrace(20, 5000), 0, 1e-3);
}

TEST(CutCoupling, ReleasesAToolThatIsDrawnOut) {
  Held tool;
  const double slack_mm = tool.loaded_n * tool.coupling.compliance_mm_per_n();
  EXPECT_NEAR(tool.retrace(-20, static_cast<int>(1.5 * slack_mm / 0.02)), 0, 1e-3);
}

TEST(CutCoupling, ALateForceDoesNotDriveAToolOutOfItsCut) {
  Held tool;
  const double c = tool.coupling.compliance_mm_per_n();
  const double unloaded_n = tool.loaded_n - 0.4 / c;
  EXPECT_LE(tool.retrace(-2, 200, {-3, 0, 0}), unloaded_n + 1e-3)
      << "it pushes to where the tool moves";
}

TEST(CutCoupling, StaysSoftWhileTheToolRestsInItsCut) {
  Held tool;
  const double c = tool.coupling.compliance_mm_per_n();
  tool.retrace(0, 2000, tool.computed.force_n);
  EXPECT_EQ(tool.coupling.compliance_mm_per_n(), c);
}

TEST(CutCoupling, NextCutForgetsTremblingOfASecondAgo) {
  Cutting tool(pen(2e-4, 0.003));
  tool.tremble(500, 0.006);
  const double before = tool.coupling.compliance_mm_per_n();
  EXPECT_GT(before, 0.5);
  for (int i = 0; i < 1000; ++i) tool.coupling.release(kArm, tool.now, kTickS);
  EXPECT_LT(tool.coupling.compliance_mm_per_n(), 0.02 * before);
}

}  // namespace
}  // namespace kerf::agent::cut_coupling_test
