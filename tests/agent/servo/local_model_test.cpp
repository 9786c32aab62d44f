// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/local_model.h"

#include "tests/support/test.h"

namespace kerf::agent::local_model_test {
namespace {

constexpr double kDt = 0.001;
constexpr double kPivotMm = 50;

PastGrip next(const PastGrip& before, Vec3 moved_mm, double dt_s = kDt) {
  PastGrip now = before;
  now.time_us += 1000;
  now.grip.pivot_mm = before.grip.pivot_mm + moved_mm;
  now.velocity = {moved_mm * (1 / dt_s), {}};
  now.path_mm += length(moved_mm);
  now.heading = LocalModel::heading(before.heading, moved_mm);
  return now;
}

PastGrip start() { return PastGrip{.time_us = 1'000'000, .grip = {.pivot_mm = {0, 0, kPivotMm}}}; }

/// Answer for a cut along +x with a force of `newtons` against it at the tip.
ServerWrench cut_of(const PastGrip& then, double newtons) {
  ServerWrench answer;
  const Vec3 arm{0, 0, -kPivotMm};
  answer.wrench = {{-newtons, 0, 0}, cross(arm, Vec3{-newtons, 0, 0})};
  answer.pose_us = then.time_us;
  answer.engaged_area_mm2 = 2;
  answer.cut_centre_mm = then.grip.pivot_mm + arm;
  return answer;
}

PastGrip move_along_x(PastGrip past, int ticks, double step_mm = 0.05) {
  for (int i = 0; i < ticks; ++i) past = next(past, {step_mm, 0, 0});
  return past;
}

TEST(LocalModel, ReproducesAnAnswerWithoutDelay) {
  LocalModel model({});
  const PastGrip now = move_along_x(start(), 200);
  const ServerWrench answer = cut_of(now, 3);
  model.take(answer, now, now);
  const Wrench output = model.at(now, now, true, kDt);
  EXPECT_NEAR(output.force_n.x, -3, 1e-9);
  EXPECT_NEAR(output.torque_nmm.y, answer.wrench.torque_nmm.y, 1e-6);
  EXPECT_EQ(model.at(now, now, false, kDt), Wrench{})
      << "no cutting force without the cutting button";
}

/// Returns the range of the rendered force over its mean, for alternating answers of this age.
double rendered_ripple(CutLaw law, double max_vibration_hz = 0, std::size_t late_ticks = 1) {
  LocalModel model({.law = law, .max_vibration_hz = max_vibration_hz});
  std::vector<PastGrip> path{move_along_x(start(), 200)};
  double least = 1e9, most = 0;
  for (int i = 0; i < 40; ++i) {
    path.push_back(next(path.back(), {0.05, 0, 0}));
    const PastGrip& now = path.back();
    const PastGrip& then = path[path.size() - 1 - std::min(late_ticks, path.size() - 1)];
    model.take_replica(cut_of(then, i % 4 < 2 ? 2.5 : 3.5), then, now);
    const double newtons = -model.at(now, now, true, kDt).force_n.x;
    if (i < 20) continue;
    least = std::min(least, newtons);
    most = std::max(most, newtons);
  }
  return (most - least) / 3;
}

TEST(LocalModel, FreshAnswersAreRenderedUnchangedAndOldOnesSmoothed) {
  constexpr std::size_t kOldTicks = 10;
  for (const CutLaw law : {CutLaw::kMechanistic, CutLaw::kSpecificEnergy}) {
    EXPECT_NEAR(rendered_ripple(law), 1.0 / 3, 1e-9);
    EXPECT_LT(rendered_ripple(law, 0, kOldTicks), 0.25);
  }
}

// A square wave of 250 Hz: a first-order low pass at f reduces its extremes by the factor tanh(pi f
// / (2 * 250 Hz)).
TEST(LocalModel, RippleAboveTheDevicesBandIsLowered) {
  for (const double hz : {50.0, 100.0, 200.0}) {
    const double expected = std::tanh(std::numbers::pi * hz / 500) / 3;
    EXPECT_NEAR(rendered_ripple(CutLaw::kMechanistic, hz), expected, 0.02 * expected) << hz;
  }
}

TEST(LocalModel, BandKeepsTheMeanForceAndForgetsItAfterACut) {
  LocalModel model({.law = CutLaw::kMechanistic, .max_vibration_hz = 50});
  PastGrip now = move_along_x(start(), 200);
  double newtons = 0;
  for (int i = 0; i < 100; ++i) {
    const PastGrip then = now;
    now = next(now, {0.05, 0, 0});
    model.take_replica(cut_of(then, 3), then, now);
    newtons = -model.at(now, now, true, kDt).force_n.x;
  }
  EXPECT_NEAR(newtons, 3, 1e-6);
  EXPECT_NEAR(-model.computed().force_n.x, 3, 1e-6);
  EXPECT_EQ(model.at(now, now, false, kDt), Wrench{}) << "the button is released";
  EXPECT_LT(-model.at(now, now, true, kDt).force_n.x, 1) << "a new cut begins";
  model.take_replica(ServerWrench{.pose_us = now.time_us}, now, now);
  EXPECT_EQ(model.at(now, now, true, kDt), Wrench{}) << "nothing is engaged";
}

TEST(LocalModel, ExtrapolatesARisingForceFromDelayedAnswers) {
  LocalModel model({});
  PastGrip path[300];
  path[0] = start();
  for (int i = 1; i < 300; ++i) path[i] = next(path[i - 1], {0.05, 0, 0});
  const auto newtons = [&](int i) { return 1 + 0.2 * path[i].path_mm; };
  constexpr int kLate = 50;
  double worst = 0, held = 0;
  for (int i = 100; i < 300; ++i) {
    model.take(cut_of(path[i - kLate], newtons(i - kLate)), path[i - kLate], path[i]);
    const double output = -model.at(path[i], path[i], true, kDt).force_n.x;
    if (i < 150) continue;
    worst = std::max(worst, std::abs(output - newtons(i)));
    held = std::max(held, std::abs(newtons(i - kLate) - newtons(i)));
  }
  EXPECT_LT(worst, 0.01);
  EXPECT_GT(held, 0.4) << "error if the answer were held";
}

TEST(LocalModel, ForceTurnsWithTheDirectionOfTravel) {
  LocalModel model({});
  PastGrip now = move_along_x(start(), 200);
  model.take(cut_of(now, 3), now, now);
  const double half = std::sqrt(0.5);
  for (int i = 0; i < 200; ++i) now = next(now, {0.05 * half, 0.05 * half, 0});
  const Vec3 force = model.at(now, now, true, kDt).force_n;
  EXPECT_NEAR(force.x, -3 * half, 0.02);
  EXPECT_NEAR(force.y, -3 * half, 0.02);
}

TEST(LocalModel, ForceFadesOnReversal) {
  LocalModel model({});
  PastGrip now = move_along_x(start(), 200);
  model.take(cut_of(now, 3), now, now);
  double before = model.at(now, now, true, kDt).force_n.x;
  for (int i = 0; i < 100; ++i) {
    now = next(now, {-0.05, 0, 0});
    const double force = model.at(now, now, true, kDt).force_n.x;
    EXPECT_LE(std::abs(force - before), 0.7) << "no step at tick " << i;
    before = force;
  }
  EXPECT_NEAR(before, 0, 1e-9);
}

TEST(LocalModel, RemovalRateLawIsADamperWithinTheDeviceLimit) {
  LocalModel model({.law = CutLaw::kRemovalRate, .max_damping = 0.04});
  PastGrip now = move_along_x(start(), 200);
  model.take(cut_of(now, 1.5), now, now);  // 50 mm/s: 0.03 N s/mm
  EXPECT_NEAR(model.at(now, now, true, kDt).force_n.x, -1.5, 1e-9);
  now = next(now, {0.1, 0, 0});
  EXPECT_NEAR(model.at(now, now, true, kDt).force_n.x, -3, 0.02) << "twice as fast";
  model.take(cut_of(now, 30), now, now);
  now = next(now, {0.05, 0, 0});
  const Wrench rendered = model.at(now, now, true, kDt);
  EXPECT_LE(std::abs(rendered.force_n.x), 0.04 * 50 + 1e-9);
  const double factor = rendered.force_n.x / model.computed().force_n.x;
  EXPECT_LT(factor, 0.2) << "what the server computes is far above the device's damping";
  EXPECT_NEAR(rendered.torque_nmm.y, factor * model.computed().torque_nmm.y, 1e-9);
}

TEST(LocalModel, RemovalRateLawIsAWeakerDamperOnAPenThatTurnsEasily) {
  const auto rendered_n = [](double inertia_kg_m2) {
    LocalModel model({.law = CutLaw::kRemovalRate,
                      .contact = {.mass_kg = 0.05, .inertia_kg_m2 = inertia_kg_m2}});
    const PastGrip now = move_along_x(start(), 200);
    model.take(cut_of(now, 0.9), now, now);
    return -model.at(now, now, true, kDt).force_n.x;
  };
  EXPECT_NEAR(rendered_n(1), 0.404, 0.01) << "half of 0.05 kg / 3.1 ms, at 50 mm/s";
  EXPECT_LT(rendered_n(1e-5), 0.05);
}

TEST(LocalModel, TorqueNotDueToTheCutCenterIsKept) {
  LocalModel model({});
  const PastGrip now = move_along_x(start(), 200);
  ServerWrench answer = cut_of(now, 3);
  answer.wrench.torque_nmm = answer.wrench.torque_nmm + Vec3{7, 0, 0};
  model.take(answer, now, now);
  EXPECT_NEAR(model.at(now, now, true, kDt).torque_nmm.x, 7, 1e-9);
}

ServerWrench wall_at(const PastGrip& then, double depth_mm, double stiffness = 1) {
  ServerWrench answer{.pose_us = then.time_us, .plane_count = 1};
  answer.planes[0] = {.point_mm = {then.grip.pivot_mm.x, 0, 0},
                      .normal = {-1, 0, 0},
                      .depth_mm = static_cast<float>(depth_mm),
                      .stiffness_n_per_mm = static_cast<float>(stiffness),
                      .radius_mm = 5,
                      .flags = wire::kContactObstacle};
  const double f = std::max(0.0, depth_mm) * stiffness;
  answer.wrench = {{-f, 0, 0}, cross(Vec3{0, 0, -kPivotMm}, Vec3{-f, 0, 0})};
  return answer;
}

constexpr ContactLimits kLimits{.max_stiffness = 2};

TEST(ContactModel, RendersAPlaneThatWasKnownBeforeContact) {
  ContactModel contact(kLimits);
  PastGrip now = start();
  contact.take(wall_at(now, -1), now.grip, now.grip, {});
  EXPECT_EQ(contact.at(now.grip, {}, kDt), Wrench{});
  now = next(now, {1.5, 0, 0});
  const Wrench output = contact.at(now.grip, {}, kDt);
  EXPECT_NEAR(output.force_n.x, -0.5, 1e-6);
  EXPECT_NEAR(output.torque_nmm.y, kPivotMm * 0.5, 1e-4);
}

TEST(ContactModel, StiffnessIsLimitedByTheDevice) {
  ContactModel contact(kLimits);
  PastGrip now = start();
  contact.take(wall_at(now, 0, 50), now.grip, now.grip, {});
  now = next(now, {0.5, 0, 0});
  EXPECT_NEAR(contact.at(now.grip, {}, kDt).force_n.x, -1, 1e-6);
  EXPECT_NEAR(contact.computed().force_n.x, -25, 1e-4) << "as the server computes it";
}

TEST(ContactModel, NewPlaneFadesInWithoutAStep) {
  ContactModel contact(kLimits);
  const PastGrip now = start();
  contact.take(wall_at(now, 2), now.grip, now.grip, {});
  EXPECT_EQ(contact.at(now.grip, {}, 0), Wrench{});
  double before = 0, most = 0;
  for (int i = 0; i < 200; ++i) {
    const double force = -contact.at(now.grip, {}, kDt).force_n.x;
    most = std::max(most, force - before);
    before = force;
  }
  EXPECT_LT(most, 0.15);
  EXPECT_NEAR(before, 2, 1e-3);
  contact.take(ServerWrench{}, now.grip, now.grip, {});
  EXPECT_NEAR(contact.at(now.grip, {}, 0).force_n.x, -2, 1e-3)
      << "a removed plane fades out without a step";
}

TEST(ContactModel, JustTouchedPlaneAddsNoForce) {
  ContactModel one(kLimits), two(kLimits);
  const PastGrip now = start();
  const auto force = [&](ContactModel& contact, const ServerWrench& answer) {
    contact.take(answer, now.grip, now.grip, {});
    for (int i = 0; i < 300; ++i) contact.at(now.grip, {}, kDt);
    return contact.at(now.grip, {}, kDt).force_n;
  };
  const ServerWrench wall = wall_at(now, 1, 50);
  ServerWrench corner = wall;
  corner.plane_count = 2;
  corner.planes[1] = wall.planes[0];
  corner.planes[1].normal = {0, 1, 0};
  corner.planes[1].depth_mm = 1e-4F;
  const Vec3 alone = force(one, wall);
  EXPECT_NEAR(alone.x, -2, 1e-6);
  EXPECT_LT(length(force(two, corner) - alone), 1e-3);
  corner.planes[1].depth_mm = 1;
  const Vec3 shared = force(two, corner);
  EXPECT_NEAR(shared.x, -1.6, 0.01) << "half of 0.8 damping / delay, 3.2 N/mm";
  EXPECT_NEAR(shared.y, 1.6, 0.01);
}

TEST(ContactModel, ForceEndsBeyondThePlanesRadius) {
  ContactModel contact(kLimits);
  PastGrip now = start();
  contact.take(wall_at(now, 0), now.grip, now.grip, {});
  now = next(now, {11, 0, 0});
  EXPECT_EQ(contact.at(now.grip, {}, kDt), Wrench{});
}

TEST(ContactModel, DampsAndNeverPulls) {
  ContactModel contact(kLimits);
  const PastGrip now = start();
  contact.take(wall_at(now, 0.5), now.grip, now.grip, {});
  for (int i = 0; i < 200; ++i) contact.at(now.grip, {}, kDt);  // until it has faded in
  EXPECT_NEAR(contact.at(now.grip, {}, kDt).force_n.x, -0.5, 1e-4);
  EXPECT_NEAR(contact.at(now.grip, {{50, 0, 0}, {}}, kDt).force_n.x, -0.7, 1e-4)
      << "0.004 N s/mm while it is pressed further";
  EXPECT_NEAR(contact.at(now.grip, {{-50, 0, 0}, {}}, kDt).force_n.x, -0.3, 1e-4);
  EXPECT_NEAR(contact.at(now.grip, {{-500, 0, 0}, {}}, kDt).force_n.x, 0, 1e-4);
}

TEST(ContactGains, FollowFromMassAndDelay) {
  const Vec3 normal{0, 0, 1};
  const ContactLimits slow{
      .mass_kg = 0.05, .inertia_kg_m2 = 1e-4, .force_delay_s = 0.004, .velocity_delay_s = 0.008};
  const ContactGains axial = stable_gains(slow, 50, {0, 0, -60}, normal, 1);
  EXPECT_NEAR(axial.damping, 0.6 * 0.05 / 0.008 / 1000, 1e-12);
  EXPECT_NEAR(axial.stiffness, 0.8 * 0.375 * 0.05 / (0.004 * 0.008) / 1000, 1e-12);
  ContactLimits weak = slow;
  weak.max_damping = 0.001;
  const double taken =
      0.001 * 0.008 / (0.05 / 1000);  // part of the mass that the late damper takes
  EXPECT_NEAR(stable_gains(weak, 50, {0, 0, -60}, normal, 1).stiffness,
              0.8 * 0.001 / (0.004 + 0.008 * taken / (2 * (1 - taken))), 1e-12);
  // Across the axis, a push at 60 mm turns a light pen: 1 / (1/m + r^2/I) = 17.9 g.
  const ContactGains across = stable_gains(slow, 50, {60, 0, 0}, normal, 1);
  EXPECT_NEAR(across.damping / axial.damping, 1 / (1 + 0.05 * 36), 1e-12);
  const ContactGains shared = stable_gains(slow, 50, {0, 0, -60}, normal, 0.5);
  EXPECT_NEAR(shared.damping, axial.damping / 2, 1e-12);
  EXPECT_NEAR(shared.stiffness, axial.stiffness / 2, 1e-12);
}

TEST(ContactGains, AreTheSurfacesOwnIfTheDeviceRendersThem) {
  const ContactLimits prompt{.max_stiffness = 3, .mass_kg = 0.3, .inertia_kg_m2 = 2e-4};
  EXPECT_EQ(stable_gains(prompt, 1.2, {0, 0, -60}, {0, 0, 1}, 1).stiffness, 1.2);
  EXPECT_EQ(stable_gains(prompt, 50, {0, 0, -60}, {0, 0, 1}, 1).stiffness, 3);
}

TEST(GripHistory, FindsTheGripOfAnAnswer) {
  GripHistory history;
  EXPECT_EQ(history.at(5), nullptr);
  for (std::uint64_t i = 1; i <= 3000; ++i) history.push({.time_us = 1000 * i});
  ASSERT_NE(history.at(2'900'500), nullptr);
  EXPECT_EQ(history.at(2'900'500)->time_us, 2'900'000U);
  EXPECT_EQ(history.at(9'000'000)->time_us, 3'000'000U);
  EXPECT_EQ(history.at(1'000'000), nullptr) << "too long ago";
}

TEST(GripHistory, FindsTheNewestGripNotLater) {
  GripHistory history;
  for (std::uint64_t count = 1; count <= 1500; ++count) {
    history.push({.time_us = 10 * count});
    if (count > 40 && count % 89 != 0) continue;
    for (std::uint64_t time = 0; time <= 10 * count + 10; ++time) {
      const std::uint64_t newest = std::min(time / 10, count);
      const bool kept = newest > 0 && newest + GripHistory::kKept > count;
      const PastGrip* found = history.at(time);
      ASSERT_EQ(found != nullptr, kept) << time << " of " << count;
      if (kept) {
        ASSERT_EQ(found->time_us, 10 * newest) << time << " of " << count;
      }
    }
  }
}

}  // namespace
}  // namespace kerf::agent::local_model_test
