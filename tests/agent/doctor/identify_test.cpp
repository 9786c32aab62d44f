// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/doctor/identify.h"

#include "haptic_agent/device/units.h"
#include "haptic_agent/servo/servo_cycle.h"
#include "haptic_agent/z_width.h"
#include "tests/support/test.h"

namespace kerf::agent::identify_test {
namespace {

/// The properties that an identification has to find.
struct Truth {
  double mass_kg = 0.2, inertia_kg_m2 = 1e-4;
  double friction_n = 0.1;
  double viscous_n_s_per_mm = 0.0005;
  std::uint64_t latency_us = 1500;
  double quantum_mm = 0.02, quantum_rad = 0.0005;
  double max_torque_nmm = 200;
};

/// A device that nobody holds, with friction, rounded poses and late wrenches.
class LooseDevice final : public HapticDevice {
 public:
  explicit LooseDevice(const Truth& truth) : truth_(truth) {}

  DeviceCapabilities capabilities() const override {
    return {.name = "loose device",
            .sensed_dof = 5,
            .actuated_dof = 5,
            .max_force_n = 10,
            .max_torque_nmm = truth_.max_torque_nmm,
            .max_stiffness_n_per_mm = 3,
            .max_damping_n_s_per_mm = 0.02};
  }
  DeviceState read(std::uint64_t now_us) noexcept override {
    for (; now_us_ < now_us; now_us_ += kStepUs) step();
    const Vec3 axis{std::sin(angle_), 0, std::cos(angle_)};
    const Vec3 tip = Vec3{x_, 0, 0} - axis * kPivotMm;
    most_mm_ = std::max(most_mm_, std::abs(x_));
    return {.tip_mm = {rounded(tip.x, truth_.quantum_mm), 0, rounded(tip.z, truth_.quantum_mm)},
            .axis = normalized({rounded(axis.x, truth_.quantum_rad), 0, axis.z}),
            .time_us = now_us,
            .valid = true,
            .phase = DevicePhase::kReady};
  }
  void write(const Wrench& wrench) noexcept override {
    written_.push_back({now_us_ + truth_.latency_us, wrench});
    most_n_ = std::max(most_n_, length(wrench.force_n));
  }
  void stop() noexcept override { write({}); }
  double most_mm() const { return most_mm_; }
  double most_n() const { return most_n_; }
  const Wrench& last() const { return written_.back().second; }

  static constexpr double kPivotMm = 60;

 private:
  static constexpr std::uint64_t kStepUs = 125;
  static constexpr double kDt = 125e-6;

  static double rounded(double value, double quantum) {
    return quantum > 0 ? quantum * std::round(value / quantum) : value;
  }
  void step() {
    while (!written_.empty() && written_.front().first <= now_us_) {
      acting_ = written_.front().second;
      if (written_.size() == 1) break;
      written_.pop_front();
    }
    const double pull = acting_.force_n.x - truth_.viscous_n_s_per_mm * v_ -
                        truth_.friction_n * std::clamp(v_ / 0.5, -1.0, 1.0);
    v_ += pull * kMmPerM / truth_.mass_kg * kDt;
    x_ += v_ * kDt;
    turn_ += acting_.torque_nmm.y / (truth_.inertia_kg_m2 * kNmmPerNm) * kDt;
    angle_ += turn_ * kDt;
  }

  Truth truth_;
  std::deque<std::pair<std::uint64_t, Wrench>> written_;
  Wrench acting_{};
  std::uint64_t now_us_ = 0;
  double x_ = 0, v_ = 0, angle_ = 0, turn_ = 0, most_mm_ = 0, most_n_ = 0;
};

std::expected<DeviceProfile, std::string> identify(LooseDevice& device) {
  Identification identification(device, LooseDevice::kPivotMm);
  std::uint64_t now_us = 1000;
  while (identification.tick(now_us)) now_us += 1000;
  EXPECT_LE(now_us, 21'000'000U);
  EXPECT_LE(device.most_n(), kShakeN);
  EXPECT_LE(device.most_mm(), kShakeMm);
  EXPECT_EQ(device.last().force_n, Vec3{});
  return identification.profile();
}

TEST(Identification, FindsMassAndQuantumWithinATenthAndLatencyAndFriction) {
  for (const Truth& truth : {Truth{},
                             Truth{.mass_kg = 0.05,
                                   .inertia_kg_m2 = 1e-5,
                                   .friction_n = 0.03,
                                   .latency_us = 0,
                                   .quantum_mm = 0.01,
                                   .quantum_rad = 0.0002},
                             Truth{.mass_kg = 0.6,
                                   .inertia_kg_m2 = 4e-4,
                                   .friction_n = 0.2,
                                   .latency_us = 3000,
                                   .quantum_mm = 0.055,
                                   .quantum_rad = 0.001}}) {
    LooseDevice device(truth);
    const auto profile = test::value_of(identify(device));
    const std::string which = std::to_string(truth.mass_kg) + " kg";
    EXPECT_NEAR(*profile.moving_mass_kg / truth.mass_kg, 1, 0.1) << which;
    EXPECT_NEAR(*profile.moving_inertia_kg_m2 / truth.inertia_kg_m2, 1, 0.1) << which;
    EXPECT_NEAR(profile.friction_n, truth.friction_n, 0.2 * truth.friction_n + 0.01) << which;
    EXPECT_NEAR(double(*profile.latency_us), double(truth.latency_us), 300) << which;
    EXPECT_NEAR(*profile.resolution_mm / truth.quantum_mm, 1, 0.1) << which;
    EXPECT_NEAR(*profile.resolution_rad / truth.quantum_rad, 1, 0.1) << which;
    EXPECT_GT(profile.wall_along_n_per_mm, 0.1) << which;
  }
}

TEST(Identification, FindsNoQuantumInAContinuousPose) {
  LooseDevice device({.quantum_mm = 0, .quantum_rad = 0});
  const auto profile = test::value_of(identify(device));
  EXPECT_EQ(*profile.resolution_mm, 0);
  EXPECT_EQ(*profile.resolution_rad, 0);
}

TEST(Identification, OmitsTheInertiaOfADeviceWithoutTorque) {
  LooseDevice device({.max_torque_nmm = 0});
  const auto profile = test::value_of(identify(device));
  EXPECT_FALSE(profile.moving_inertia_kg_m2);
  EXPECT_NEAR(*profile.moving_mass_kg, 0.2, 0.02);
}

TEST(Identification, EndsWithoutForceIfTheDeviceIsStuck) {
  LooseDevice device({.friction_n = 5});
  const auto error = test::error_of(identify(device));
  EXPECT_NE(error.find("force: "), std::string::npos) << error;
}

TEST(Identification, EndsOnANonFinitePose) {
  class Broken final : public HapticDevice {
   public:
    DeviceCapabilities capabilities() const override {
      return {.name = "broken", .max_force_n = 10};
    }
    DeviceState read(std::uint64_t now_us) noexcept override {
      return {.tip_mm = {now_us < 1'000'000 ? 0 : std::nan(""), 0, 0},
              .time_us = now_us,
              .valid = true,
              .phase = DevicePhase::kReady};
    }
    void write(const Wrench& wrench) noexcept override { last = wrench; }
    void stop() noexcept override {}
    Wrench last{{1, 0, 0}, {}};
  } device;
  Identification identification(device, 60);
  std::uint64_t now_us = 1000;
  while (identification.tick(now_us) && now_us < 2'000'000) now_us += 1000;
  EXPECT_LE(now_us, 1'002'000U);
  EXPECT_EQ(device.last, Wrench{});
  EXPECT_NE(identification.profile().error().find("moved too far"), std::string::npos);
}

TEST(Identification, FailsIfTheLoopLosesTicks) {
  LooseDevice device({});
  Identification identification(device, LooseDevice::kPivotMm);
  std::uint64_t now_us = 1000;
  for (int i = 0; identification.tick(now_us); ++i) now_us += i % 50 == 0 ? 2000 : 1000;
  const auto error = test::error_of(identification.profile());
  EXPECT_NE(error.find("the loop lost 3"), std::string::npos) << error;
}

TEST(Identification, AnnouncesItsMotionFirst) {
  const std::string text = identification_warning(LooseDevice({}).capabilities());
  for (const char* part : {"keep your hands off the loose device", "up to 1 N", "20 N·mm", "10 mm"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " in: " << text;
}

TEST(DeviceProfile, RoundTripsAndReplacesDeclaredValues) {
  const std::string path = std::filesystem::path(testing::TempDir()) / "kerf_profile_test.txt";
  DeviceProfile profile{.device = "loose device", .latency_us = 1500, .resolution_mm = 0.02};
  profile.moving_mass_kg = 0.2;
  profile.friction_n = 0.03;
  profile.wall_across_n_per_mm = 1.5;
  ASSERT_TRUE(write_profile(path, profile));
  const auto read = test::value_of(read_profile(path));
  EXPECT_EQ(read.device, "loose device");
  EXPECT_FALSE(read.moving_inertia_kg_m2);
  EXPECT_DOUBLE_EQ(read.friction_n, 0.03);
  EXPECT_DOUBLE_EQ(read.wall_across_n_per_mm, 1.5);
  const DeviceCapabilities known = with_profile(
      {.name = "x", .latency_us = 1000, .moving_mass_kg = 1, .moving_inertia_kg_m2 = 2}, read);
  EXPECT_EQ(known.latency_us, 1500U);
  EXPECT_DOUBLE_EQ(known.resolution_mm, 0.02);
  EXPECT_DOUBLE_EQ(known.moving_mass_kg, 0.2);
  EXPECT_DOUBLE_EQ(known.moving_inertia_kg_m2, 2) << "not measured";
  std::ofstream(path) << "kerf-device-profile 1\nmoving_mass_kg -1\n";
  EXPECT_NE(read_profile(path).error().find(":2: moving_mass_kg must be"), std::string::npos);
  std::ofstream(path) << "hello\n";
  EXPECT_NE(read_profile(path).error().find("is no device profile"), std::string::npos);
  std::filesystem::remove(path);
}

TEST(DeviceProfile, DoesNotLowerTheDeclaredLatency) {
  const DeviceProfile profile{.latency_us = 1500};
  EXPECT_EQ(with_profile({.latency_us = 9000}, profile).latency_us, 9000U);
  EXPECT_EQ(with_profile({.latency_us = 0}, profile).latency_us, 1500U);
}

TEST(DeviceProfile, OmitsAStepThatWasNotFound) {
  const std::string path = std::filesystem::path(testing::TempDir()) / "kerf_no_step.txt";
  const DeviceProfile profile{.resolution_mm = 0, .resolution_rad = 0.0005};
  ASSERT_TRUE(write_profile(path, profile));
  const auto read = test::value_of(read_profile(path));
  EXPECT_FALSE(read.resolution_mm);
  EXPECT_DOUBLE_EQ(read.resolution_rad.value(), 0.0005);
  const DeviceCapabilities declared{.resolution_mm = 0.01, .resolution_rad = 0.001};
  EXPECT_DOUBLE_EQ(with_profile(declared, read).resolution_mm, 0.01);
  EXPECT_DOUBLE_EQ(with_profile(declared, read).resolution_rad, 0.0005);
  // Files of earlier versions contain a zero.
  std::ofstream(path) << "kerf-device-profile 1\nresolution_mm 0\n";
  EXPECT_DOUBLE_EQ(with_profile(declared, *read_profile(path)).resolution_mm, 0.01);
}

TEST(DeviceProfile, MatchesOnlyTheDeviceItNames) {
  const DeviceProfile profile{.device = "loose device"};
  EXPECT_EQ(profile_mismatch(profile, {.name = "loose device"}), "");
  EXPECT_EQ(profile_mismatch(profile, {.name = " loose device "}), "") << "files hold no edges";
  EXPECT_EQ(profile_mismatch({}, {.name = "pen"}), "") << "written by hand, for any device";
  EXPECT_EQ(profile_mismatch(profile, {.name = "pen"}),
            "the profile was measured on the loose device, and this is the pen; measure this "
            "device with kerf-agent doctor --identify FILE, or leave --profile out");
}

/// Walls of devices with the ratings in the table of tests/bench/results/agent.md.
TEST(ZWidth, UsesTheDeclaredDamping) {
  const auto width = [](const DeviceCapabilities& device) {
    return z_width(settings_for(device, {}));
  };
  const DeviceCapabilities omega{.max_force_n = 12,
                                 .max_stiffness_n_per_mm = 14.5,
                                 .max_damping_n_s_per_mm = 0.03,
                                 .latency_us = 1000};
  EXPECT_NEAR(width(omega).along.stiffness, 6.9, 0.05);
  const DeviceCapabilities touch{.max_force_n = 3.3,
                                 .max_stiffness_n_per_mm = 0.5,
                                 .max_damping_n_s_per_mm = 0.005,
                                 .latency_us = 1000};
  EXPECT_EQ(width(touch).along.stiffness, 0.5);
  EXPECT_EQ(z_width_notice(touch, settings_for(touch, {})).find("would oscillate"),
            std::string::npos);
  DeviceCapabilities pen{.max_force_n = 10,
                         .max_stiffness_n_per_mm = 3,
                         .max_damping_n_s_per_mm = 0.06,
                         .moving_mass_kg = 0.05,
                         .moving_inertia_kg_m2 = 1e-5};
  EXPECT_NEAR(width(pen).across.stiffness, 1.23, 0.01);
  pen.latency_us = 1000;
  EXPECT_NEAR(width(pen).across.stiffness, 0.266, 0.005);
  pen.latency_us = 3000;
  EXPECT_NEAR(width(pen).across.stiffness, 0.065, 0.005);
}

TEST(ZWidth, StatesWhyTheDeclaredStiffnessIsNotRendered) {
  const DeviceCapabilities pen{.max_force_n = 10,
                               .max_torque_nmm = 250,
                               .max_stiffness_n_per_mm = 3,
                               .max_damping_n_s_per_mm = 0.06,
                               .latency_us = 1000,
                               .moving_mass_kg = 0.05,
                               .moving_inertia_kg_m2 = 1e-5};
  const std::string text = z_width_notice(pen, settings_for(pen, {}));
  for (const char* part : {"walls are rendered with up to", "the declared 3 N/mm would oscillate",
                           "its tip moves 2.6 g", "1.5 ms after"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " in: " << text;
  DeviceCapabilities heavy = pen;
  heavy.moving_mass_kg = 0.5;
  heavy.moving_inertia_kg_m2 = 1e-2;
  heavy.max_stiffness_n_per_mm = 100;
  heavy.max_damping_n_s_per_mm = 1;
  heavy.resolution_mm = 1e-4;
  const std::string large = z_width_notice(heavy, settings_for(heavy, {}));
  EXPECT_NE(large.find("the declared 100 N/mm"), std::string::npos) << large;
  EXPECT_NE(large.find("its tip moves 420 g"), std::string::npos) << large;
  EXPECT_EQ(large.find("e+"), std::string::npos) << large;
  EXPECT_GT(z_width(settings_for(pen, {})).across.stiffness, 0.25)
      << "twice that of a usual filter";
  EXPECT_EQ(z_width_notice({}, settings_for({}, {})), "") << "no motors";
}

}  // namespace
}  // namespace kerf::agent::identify_test
