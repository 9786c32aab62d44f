// SPDX-License-Identifier: Apache-2.0
// The mechanistic law compared with closed forms of Altintas' linear-edge model, derived by hand. A
// tooth at the angle phi, clockwise from the left of the feed, has the chip f sin phi, and is
// pushed by T against its motion and by R into the tool: Fx = -T cos phi - R sin phi, Fy = T sin
// phi - R cos phi; Fz = -A. The mean of N teeth is N / (2 pi) times the integral.

#include "kernel/force/milling_force.h"

#include "kernel/force/cutting_force.h"
#include "kernel/force/milling_presets.h"
#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::milling_force_test {
namespace {

constexpr double kRadius = 3, kDepth = 2, kStep = 0.03, kPitch = 0.2;
const Vec3 kUp{0, 0, 1};

/// Coefficients of different sizes in all directions, mean forces only.
MillingSettings milling() {
  return MillingSettings{.spindle_rpm = 12000,
                         .teeth = 2,
                         .ripple_hz = 0,
                         .cut_n_per_mm2 = {800, 300, 200},
                         .edge_n_per_mm = {20, 30, 5}};
}

SculptureSettings settings_of(const MillingSettings& m, Rays rays) {
  return SculptureSettings{.stock = BoxStock{{-12, -12, -8}, {12, 12, 0}},
                           .rays = rays,
                           .pitch_mm = kPitch,
                           .tolerance_mm = 0.001,
                           .keep_normals = false,
                           .force = {.law = ForceLaw::kMechanistic, .milling = m}};
}

/// A cut along +X with the axis at `y`, in ticks, the last of which are compared.
struct Cut {
  MillingSettings milling;
  Rays rays = Rays::kTriDexel;
  double y = 0.0213;
  double depth_mm = kDepth;
  double tick_s = 0.001;
  int ticks = 150;
};

std::vector<Vec3> forces_of(const Cut& cut) {
  Sculpture block = *Sculpture::create(settings_of(cut.milling, cut.rays));
  block.apply(DefineTool{1, *make_tool(FlatShape{2 * kRadius, 30})}).value();
  constexpr int kLead = 40;
  const Vec3 start{-4.0371, cut.y, -cut.depth_mm};
  block.apply(MoveTool{1, {{-20, cut.y, -cut.depth_mm}, kUp}, {start, kUp}, 1, false}).value();
  std::vector<Vec3> forces;
  for (int i = 0; i < kLead + cut.ticks; ++i) {
    const Vec3 from = start + Vec3{i * kStep, 0, 0}, to = start + Vec3{(i + 1) * kStep, 0, 0};
    const auto r = block.apply(MoveTool{1, {from, kUp}, {to, kUp}, cut.tick_s}).value();
    if (i >= kLead) forces.push_back(r.wrench.force_n);
  }
  return forces;
}

Vec3 mean(const std::vector<Vec3>& forces) {
  Vec3 sum;
  for (const Vec3& f : forces) sum = sum + f * (1 / double(forces.size()));
  return sum;
}

/// The mean force of the model between two angles, integrated numerically.
Vec3 model(const MillingSettings& m, double from_rad, double to_rad, double depth_mm = kDepth) {
  const double feed = kStep / (0.001 * m.spindle_rpm / 60 * m.teeth);
  constexpr int kSteps = 20000;
  Vec3 sum;
  for (int i = 0; i < kSteps; ++i) {
    const double phi = from_rad + (to_rad - from_rad) * (i + 0.5) / kSteps;
    const double chip = feed * std::sin(phi);
    const auto c = [chip](double n) { return chip * std::pow(std::max(chip, 5e-5), -n); };
    const EdgeCoefficients &k = m.cut_n_per_mm2, &e = m.chip_exponents;
    const double t = k.tangential * c(e.tangential) + m.edge_n_per_mm.tangential;
    const double r = k.radial * c(e.radial) + m.edge_n_per_mm.radial;
    const double a = k.axial * c(e.axial) + m.edge_n_per_mm.axial;
    sum = sum +
          Vec3{-t * std::cos(phi) - r * std::sin(phi), t * std::sin(phi) - r * std::cos(phi), -a};
  }
  return sum * ((to_rad - from_rad) / kSteps * depth_mm * m.teeth / (2 * M_PI));
}

void expect_near(Vec3 got, Vec3 wanted, double share, const char* what) {
  EXPECT_LT(length(got - wanted), share * length(wanted))
      << what << ": " << got.x << " " << got.y << " " << got.z << ", wanted " << wanted.x << " "
      << wanted.y << " " << wanted.z;
}

/// One field locates walls along its rays to a pitch, which lowers the edges' forces where they
/// graze.
double allowed(Rays rays) { return rays == Rays::kDexel ? 0.05 : 0.015; }

TEST(MillingForce, TestModelMatchesTheClosedFormOfASlot) {
  const MillingSettings m = milling();
  const double feed = kStep / (0.001 * 200 * 2), na = 2 * kDepth;
  const Vec3 closed{-na / 4 * 300 * feed - na / M_PI * 30, na / 4 * 800 * feed + na / M_PI * 20,
                    -na / M_PI * 200 * feed - na / 2 * 5};
  expect_near(model(m, 0, M_PI), closed, 1e-6, "slot");
}

TEST(MillingForce, SlotHasTheMeanForceOfTheModel) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    expect_near(mean(forces_of({milling(), rays})), model(milling(), 0, M_PI), allowed(rays),
                to_string(rays));
  }
}

TEST(MillingForce, UpAndDownMillingHaveTheMeanForcesOfTheModel) {
  // Half immersion: the tool's left (up milling, the chip begins thin) or right half is engaged.
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    const Vec3 up = mean(forces_of({milling(), rays, -12}));
    const Vec3 down = mean(forces_of({milling(), rays, 12}));
    expect_near(up, model(milling(), 0, M_PI / 2), allowed(rays), "up");
    expect_near(down, model(milling(), M_PI / 2, M_PI), allowed(rays), "down");
    EXPECT_GT(down.x, 0);  // Down milling pulls the tool along.
  }
}

TEST(MillingForce, EdgesPushWithoutAChip) {
  MillingSettings m = milling();
  m.cut_n_per_mm2 = {};
  expect_near(mean(forces_of({m})), model(m, 0, M_PI), 0.015, "edges");
}

TEST(MillingForce, ThinChipsAreHarderUnderKienzlesLaw) {
  MillingSettings m = milling();
  m.chip_exponents = in_all_directions(0.3);
  expect_near(mean(forces_of({m})), model(m, 0, M_PI), 0.015, "slot");
}

TEST(MillingForce, EachDirectionHasItsOwnExponent) {
  MillingSettings m = milling();
  for (const EdgeCoefficients& exponents :
       {EdgeCoefficients{0.6, 0, 0}, {0, 0.6, 0}, {0, 0, 0.6}, {0.25, 0.55, 0.7}}) {
    m.chip_exponents = exponents;
    expect_near(mean(forces_of({m})), model(m, 0, M_PI), 0.015, "slot");
  }
}

TEST(MillingForce, FixedFeedPerToothDoesNotDependOnTheSpeed) {
  MillingSettings m = milling();
  m.feed_per_tooth_mm = 0.075;
  const Vec3 fast = mean(forces_of({.milling = m, .ticks = 60}));
  const Vec3 slow = mean(forces_of({.milling = m, .tick_s = 0.01, .ticks = 60}));
  expect_near(slow, fast, 1e-9, "slow");
  m.feed_per_tooth_mm = 0;
  const Vec3 thin = mean(forces_of({.milling = m, .tick_s = 0.01, .ticks = 60}));
  EXPECT_LT(length(thin), 0.8 * length(fast));
}

TEST(MillingForce, OneLongMotionHasTheForceOfItsTicks) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    Sculpture block = *Sculpture::create(settings_of(milling(), rays));
    block.apply(DefineTool{1, *make_tool(FlatShape{2 * kRadius, 30})}).value();
    const auto at = [](double x) { return ToolPose{{x, 0.0213, -kDepth}, kUp}; };
    block.apply(MoveTool{1, at(-20), at(-6), 1, false}).value();
    const auto r = block.apply(MoveTool{1, at(-6), at(6), 0.4}).value();
    expect_near(r.wrench.force_n, model(milling(), 0, M_PI), allowed(rays), to_string(rays));
  }
}

TEST(MillingForce, OneLongMotionOfABallHasTheForceOfItsTicks) {
  // The floor of a groove is grazed: most of its edge forces come from the last 0.1 mm of columns.
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    Sculpture block = *Sculpture::create(settings_of(milling(), rays));
    block.apply(DefineTool{1, *make_tool(BallShape{4 * kRadius, 30})}).value();
    const auto at = [](double x) { return ToolPose{{x, 0.0213, -kDepth}, kUp}; };
    block.apply(MoveTool{1, at(-20), at(-4), 1, false}).value();
    Vec3 ticks;
    constexpr int kTicks = 100, kLead = 20;
    for (int i = 0; i < kLead + kTicks; ++i) {
      const auto r =
          block.apply(MoveTool{1, at(-4 + i * kStep), at(-4 + (i + 1) * kStep), 0.001}).value();
      if (i >= kLead) ticks = ticks + r.wrench.force_n * (1.0 / kTicks);
    }
    const double x = -4 + (kLead + kTicks) * kStep, ahead = 4;
    const auto r = block.apply(MoveTool{1, at(x), at(x + ahead), 0.001 * ahead / kStep}).value();
    expect_near(r.wrench.force_n, ticks, 0.05, to_string(rays));
  }
}

/// Least and greatest Fy over the mean.
std::pair<double, double> ripple_of(const Cut& cut) {
  const std::vector<Vec3> forces = forces_of(cut);
  const auto [least, most] = std::ranges::minmax(forces, {}, &Vec3::y);
  return {least.y / mean(forces).y, most.y / mean(forces).y};
}

/// Straight teeth that pass 200 times a second, with a tangential force only. Two of them in a slot
/// push with sin² θ.
Cut straight_teeth() {
  Cut cut{.milling = milling(), .tick_s = 0.00025, .ticks = 200};
  cut.milling.helix_deg = 0;
  cut.milling.spindle_rpm = 6000;
  cut.milling.cut_n_per_mm2 = {800, 0, 0};
  cut.milling.edge_n_per_mm = {};
  cut.milling.ripple_hz = 250;
  return cut;
}

TEST(MillingForce, ToothPassingShowsInTheWrenchUpToTheBand) {
  Cut cut = straight_teeth();
  const auto [least, most] = ripple_of(cut);
  // The mean over a tick of a cosine of 200 Hz: sin(pi 0.05) / (pi 0.05).
  EXPECT_NEAR(least, 1 - 0.9959, 0.03);
  EXPECT_NEAR(most, 1 + 0.9959, 0.03);
  cut.milling.ripple_hz = 150;
  const auto [low, high] = ripple_of(cut);
  EXPECT_NEAR(low, 1, 0.02);
  EXPECT_NEAR(high, 1, 0.02);
}

TEST(MillingForce, SlowTicksLeaveOutTheRipple) {
  Cut cut = straight_teeth();
  cut.tick_s = 0.004;
  cut.ticks = 60;
  const auto [least, most] = ripple_of(cut);
  EXPECT_NEAR(least, 1, 0.02);
  EXPECT_NEAR(most, 1, 0.02);
}

TEST(MillingForce, HelixSpanningAToothPitchHasNoRipple) {
  // At any angle of the spindle, the same lengths of edge are engaged.
  Cut cut = straight_teeth();
  cut.milling.helix_deg = 60;
  cut.depth_mm = M_PI * kRadius / std::tan(M_PI / 3);
  const auto [least, most] = ripple_of(cut);
  EXPECT_NEAR(least, 1, 0.04);
  EXPECT_NEAR(most, 1, 0.04);
}

TEST(MillingForce, RunoutScalesWithTheSlopeOfTheChipForce) {
  Cut cut = straight_teeth();
  cut.milling.ripple_hz = 150;
  cut.ticks = 280;
  cut.milling.runout_mm = 0.005;
  cut.milling.chip_exponents = {0.3, 0, 0.6};
  const std::vector<Vec3> forces = forces_of(cut);
  const auto [least, most] = std::ranges::minmax(forces, {}, &Vec3::y);
  // The first harmonic of K (1 - m) f^-m sin^(1-m) phi 2 e a, with the opposite sign on each half
  // turn.
  const double feed = kStep / (cut.tick_s * 200), m = 0.3;
  const double turned =
      std::sqrt(M_PI) * std::tgamma((3 - m) / 2) / std::tgamma((2 - m) / 2 + 1) * 2 / M_PI;
  const double wanted = 800 * (1 - m) * std::pow(feed, -m) * 0.01 * kDepth * turned;
  EXPECT_NEAR((most.y - least.y) / 2, wanted, 0.1 * wanted);
}

TEST(MillingForce, RunoutAddsTheSpindlesFrequencyAndKeepsTheMean) {
  Cut cut = straight_teeth();
  cut.milling.ripple_hz = 150;
  cut.ticks = 280;
  const Vec3 plain = mean(forces_of(cut));
  cut.milling.runout_mm = 0.005;
  const std::vector<Vec3> forces = forces_of(cut);
  expect_near(mean(forces), plain, 0.01, "mean");
  // Two teeth lead each other by 2 e: K 2 e a sin phi over half a turn, and its negative over the
  // other half. The first harmonic in y has the amplitude of K 2 e a.
  const auto [least, most] = std::ranges::minmax(forces, {}, &Vec3::y);
  EXPECT_NEAR((most.y - least.y) / 2, 800 * 0.01 * kDepth, 0.07 * 800 * 0.01 * kDepth);
}

TEST(MillingForce, IsZeroAtRestAndInAir) {
  Sculpture block = *Sculpture::create(settings_of(milling(), Rays::kTriDexel));
  block.apply(DefineTool{1, *make_tool(FlatShape{2 * kRadius, 30})}).value();
  const auto at = [](double x, double z) { return ToolPose{{x, 0, z}, kUp}; };
  EXPECT_GT(length(block.apply(MoveTool{1, at(-16, -2), at(-10, -2), 0.1})->wrench.force_n), 0);
  EXPECT_EQ(block.apply(MoveTool{1, at(-10, -2), at(-10, -2), 0.1})->wrench, Wrench{});
  EXPECT_EQ(block.apply(MoveTool{1, at(-10, 2), at(0, 2), 0.1})->wrench, Wrench{});
}

TEST(MillingForce, OtherLawsLeaveNothingPendingForIt) {
  SculptureSettings s = settings_of(milling(), Rays::kDexel);
  s.force.law = ForceLaw::kSpecificEnergy;
  Engagement engagement(s.pitch_mm);
  const Tool tool = *make_tool(FlatShape{2 * kRadius, 30});
  const ToolMotion motion = make_motion({{}, kUp}, {{1, 0, 0}, kUp}, 30);
  {
    CuttingForce force(s.force, tool, motion, 1, 1, engagement);
  }
  EXPECT_EQ(engagement.milling, nullptr);
}

TEST(MillingPresets, AreSortedPositiveAndNameTheirSources) {
  const auto presets = milling_presets();
  EXPECT_TRUE(std::ranges::is_sorted(
      presets, {}, [](const MillingPreset& p) { return std::string_view(p.material); }));
  for (const MillingPreset& p : presets) {
    EXPECT_GT(p.cut_n_per_mm2.tangential, 0) << p.material;
    EXPECT_LE(p.chip_exponent, kChipExponentMax) << p.material;
    EXPECT_GT(std::string_view(p.source).size(), 20U) << p.material;
  }
}

const MillingPreset& preset(std::string_view material) {
  return *std::ranges::find(milling_presets(), material,
                            [](const MillingPreset& p) { return std::string_view(p.material); });
}

// Densities of dry wood in g/cm³, from tables of the wood trade.
TEST(MillingPresets, LimewoodFollowsTheDensityOfTheOtherWoods) {
  const std::pair<const char*, double> woods[] = {
      {"balsa", 0.15}, {"beech", 0.71}, {"oak", 0.675}, {"pine", 0.55}, {"spruce", 0.405}};
  double mean = 0;
  for (const auto& [wood, density] : woods)
    mean += preset(wood).cut_n_per_mm2.tangential / density / std::size(woods);
  for (const auto& [wood, density] : woods) {
    EXPECT_NEAR(preset(wood).cut_n_per_mm2.tangential, mean * density, 0.145 * mean * density)
        << wood;
    EXPECT_EQ(preset(wood).chip_exponent, preset("limewood").chip_exponent);
  }
  EXPECT_NEAR(preset("limewood").cut_n_per_mm2.tangential, mean * 0.535, 0.05);
}

// Minimizes the force of a chip without rake over the angle of its shear plane, by trial.
TEST(MillingPresets, PomFollowsMerchantsChip) {
  constexpr double kYield = 67.3, kFriction = 0.2;
  const double beta = std::atan(kFriction);
  double least = 1e9;
  for (double phi = 0.1; phi < 1.4; phi += 1e-4) {
    least = std::min(least, kYield / 2 * std::cos(beta) / (std::sin(phi) * std::cos(phi + beta)));
    if (std::cos(phi + beta + 1e-4) <= 0) break;
  }
  const EdgeCoefficients& pom = preset("pom").cut_n_per_mm2;
  EXPECT_NEAR(pom.tangential, least, 0.05);
  EXPECT_NEAR(pom.radial, kFriction * least, 0.05);
}

TEST(MillingPresets, SteelC45FollowsKienzle) {
  EXPECT_EQ(preset("steel-c45").cut_n_per_mm2.tangential, 1.2 * 2220);
  EXPECT_EQ(preset("steel-c45").chip_exponent, 0.14);
}

}  // namespace
}  // namespace kerf::milling_force_test
