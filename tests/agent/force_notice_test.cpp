// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/force_notice.h"

#include "haptic_agent/plain_number.h"
#include "tests/support/test.h"

namespace kerf::agent::force_notice_test {
namespace {

Welcome welcome_of(CutLaw law, double specific, double drr) {
  return Welcome{.law = law, .specific_force_n_per_mm2 = specific, .drr_n_s_per_mm3 = drr};
}

/// The 5-DOF reference device at a pivot of 60 mm: 6 N, 150 N·mm, 0.005 N s/mm.
ServoSettings reference_settings() {
  return settings_for({.max_force_n = 10, .max_torque_nmm = 250, .max_damping_n_s_per_mm = 0.01},
                      {});
}

TEST(ForceNotice, StatesTheEngagementAboveWhichTheForceIsReduced) {
  const std::string text =
      force_notice(welcome_of(CutLaw::kSpecificEnergy, 0.5, 0), reference_settings(), 3, 180);
  for (const char* part : {"above 5 mm²", "2.5 N at the tip, 150 N·mm about the pivot",
                           "down to 0.028", "tool 3 (180 mm², 90 N)", "both by one factor"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " in: " << text;
  }
}

TEST(ForceNotice, LargeAndSmallNumbersArePlainDecimals) {
  // 2.5 N over 0.0165 N/mm² is 151.5 mm².
  const std::string text =
      force_notice(welcome_of(CutLaw::kSpecificEnergy, 0.0165, 0), reference_settings(), 3, 123456);
  for (const char* part : {"above 150 mm²", "(123000 mm², 2040 N)", "down to 0.0012"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " in: " << text;
  }
  EXPECT_EQ(text.find("e+"), std::string::npos) << text;
}

TEST(PlainNumber, HasTheRequestedDigits) {
  EXPECT_EQ(plain_number(151.5, 2), "150");
  EXPECT_EQ(plain_number(99.6, 2), "100");
  EXPECT_EQ(plain_number(9.96, 2), "10");
  EXPECT_EQ(plain_number(0.0996, 2), "0.1");
  EXPECT_EQ(plain_number(0.00001234, 2), "0.000012");
  EXPECT_EQ(plain_number(-2.5, 3), "-2.5");
  EXPECT_EQ(plain_number(0, 2), "0");
}

TEST(ForceNotice, ViscousLawIsLimitedByTheDampingOfTheDevice) {
  const std::string text =
      force_notice(welcome_of(CutLaw::kRemovalRate, 0, 0.01), reference_settings(), 1, 180);
  for (const char* part : {"above 0.5 mm²", "0.005 N s/mm", "down to 0.0028"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << " in: " << text;
  }
}

TEST(ForceNotice, IsEmptyIfNoCutExceedsTheDevice) {
  const ServoSettings settings = reference_settings();
  const Welcome soft = welcome_of(CutLaw::kSpecificEnergy, 0.01, 0);
  EXPECT_EQ(force_notice(soft, settings, 1, 249), "") << "2.49 N, of 2.5";
  EXPECT_NE(force_notice(soft, settings, 1, 251), "");
  EXPECT_EQ(force_notice(welcome_of(CutLaw::kSpecificEnergy, 0.5, 0), settings_for({}, {}), 1, 180),
            "")
      << "a device without motors outputs nothing";
  EXPECT_EQ(force_notice(welcome_of(CutLaw::kSpecificEnergy, 0.5, 0), settings, 1, 0), "")
      << "an unknown tool";
}

/// A pen with motors, held at 60 mm from the tip.
ServoSettings pen(double inertia_kg_m2, std::uint32_t latency_us) {
  return settings_for({.max_force_n = 10,
                       .max_torque_nmm = 250,
                       .max_stiffness_n_per_mm = 3,
                       .max_damping_n_s_per_mm = 0.06,
                       .latency_us = latency_us,
                       .moving_mass_kg = 0.05,
                       .moving_inertia_kg_m2 = inertia_kg_m2},
                      {});
}

TEST(GripNotice, WarnsAboutADeviceTooLightForItsLatency) {
  for (const char* part : {"0.15 N/mm", "wrong by a tenth", "firm grip"}) {
    EXPECT_NE(grip_notice(pen(1e-5, 1000)).find(part), std::string::npos) << part;
  }
  EXPECT_NE(grip_notice(pen(3e-5, 3000)), "");
}

TEST(GripNotice, IsEmptyForDevicesHeavyEnough) {
  EXPECT_EQ(grip_notice(pen(2e-4, 1000)), "");
  EXPECT_EQ(grip_notice(pen(3e-5, 1000)), "");
  EXPECT_EQ(grip_notice(pen(1e-5, 0)), "");
  EXPECT_EQ(grip_notice(settings_for({}, {})), "") << "no motors";
  ServoSettings viscous = pen(1e-5, 3000);
  viscous.model.law = CutLaw::kRemovalRate;
  EXPECT_EQ(grip_notice(viscous), "") << "this law is limited by its damping instead";
}

}  // namespace
}  // namespace kerf::agent::force_notice_test
