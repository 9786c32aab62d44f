// SPDX-License-Identifier: Apache-2.0
#include "tests/agent/library/library_rig.h"
#include "tests/support/test.h"

namespace kerf::agent::library_mapping_test {
namespace {

class LibraryMappingTest : public LibraryTest {
 protected:
  kerf_agent_mapping mapping() {
    auto mapping = sized<kerf_agent_mapping>();
    EXPECT_EQ(kerf_agent_get_mapping(agent_, &mapping), KERF_AGENT_OK);
    return mapping;
  }
  kerf_agent_result set(const kerf_agent_mapping& mapping) {
    return kerf_agent_set_mapping(agent_, &mapping);
  }
};

TEST_F(LibraryMappingTest, FaultsNameTheirField) {
  serve();
  connect();
  const auto fault = [&](auto change) {
    auto mapping = sized<kerf_agent_mapping>();
    change(mapping);
    EXPECT_EQ(set(mapping), KERF_AGENT_INVALID);
    return std::string(kerf_agent_last_error());
  };
  using M = kerf_agent_mapping;
  EXPECT_EQ(fault([](M& m) { m.scale = -1; }), "mapping: scale must be 0.001 to 1000, or 0");
  EXPECT_EQ(fault([](M& m) { m.scale = std::numeric_limits<double>::quiet_NaN(); }),
            "mapping: scale must be 0.001 to 1000, or 0");
  EXPECT_EQ(fault([](M& m) { m.force_gain = 1e3; }),
            "mapping: force_gain must be 0.01 to 100, or 0");
  EXPECT_EQ(fault([](M& m) { m.turn_rad[1] = 7; }),
            "mapping: turn_rad must be finite and at most 2 pi long");
  EXPECT_EQ(fault([](M& m) { m.block_mm[0] = 1e6; }),
            "mapping: device_mm and block_mm must be from -1e5 to 1e5");
  EXPECT_EQ(fault([](M& m) { m.flags = 8; }), "mapping: unknown bits in flags");
  EXPECT_EQ(fault([](M& m) { m.flags = KERF_AGENT_MAPPING_FIT; }),
            "mapping: FIT requires the device's workspace: state workspace_min_mm and "
            "workspace_max_mm");
  EXPECT_EQ(kerf_agent_set_mapping(agent_, nullptr), KERF_AGENT_INVALID);
  EXPECT_EQ(kerf_agent_set_mapping(nullptr, nullptr), KERF_AGENT_INVALID);
  auto wrong = sized<kerf_agent_mapping>();
  wrong.struct_size = 0;
  EXPECT_EQ(set(wrong), KERF_AGENT_UNSUPPORTED);
  EXPECT_EQ(mapping().scale, 1) << "none of them has been set";
}

TEST_F(LibraryMappingTest, StatesScaleGainAndStiffness) {
  device_.workspace_min_mm[0] = device_.workspace_min_mm[1] = device_.workspace_min_mm[2] = -50;
  device_.workspace_max_mm[0] = device_.workspace_max_mm[1] = device_.workspace_max_mm[2] = 50;
  serve();
  connect();
  EXPECT_EQ(mapping().scale, 1);
  EXPECT_EQ(mapping().stiffness_scale, 1);
  auto given = sized<kerf_agent_mapping>();
  given.flags = KERF_AGENT_MAPPING_FIT;
  given.force_gain = 2;
  ASSERT_EQ(set(given), KERF_AGENT_OK) << kerf_agent_last_error();
  auto session = sized<kerf_agent_session>();
  ASSERT_EQ(kerf_agent_get_session(agent_, &session), KERF_AGENT_OK);
  double longest = 0;
  for (int i = 0; i < 3; ++i) {
    longest = std::max(longest, session.stock_max_mm[i] - session.stock_min_mm[i]);
    EXPECT_NEAR(mapping().block_mm[i], (session.stock_max_mm[i] + session.stock_min_mm[i]) / 2,
                1e-12);
  }
  EXPECT_NEAR(mapping().scale, longest / 80, 1e-12);
  EXPECT_NEAR(mapping().stiffness_scale, 2 * mapping().scale, 1e-12);
  EXPECT_EQ(mapping().flags, std::uint32_t{KERF_AGENT_MAPPING_FIT});
}

TEST_F(LibraryMappingTest, SurfaceIsFeltThroughScaleAndGain) {
  serve();
  connect();
  auto given = sized<kerf_agent_mapping>();
  given.flags = KERF_AGENT_MAPPING_PLACE;
  given.scale = 2;
  given.force_gain = 0.5;
  ASSERT_EQ(set(given), KERF_AGENT_OK);
  // 3 mm of the hand are 6 mm in the block, 3 N there, and half of that at the hand.
  EXPECT_TRUE(feel()) << wrench_.force_n[2];
  EXPECT_NEAR(wrench_.force_n[2], kServedN, 0.1);
}

TEST_F(LibraryMappingTest, ClutchHoldsTheToolWithoutForce) {
  serve();
  connect();
  EXPECT_TRUE(feel());
  kerf_agent_pose pose = pose_at(-kPressedMm, KERF_AGENT_CLUTCH);
  EXPECT_TRUE(tick_until(pose, [&] {
    pose.tip_mm[2] += 0.02;
    return pose.tip_mm[2] > 10;
  }));
  EXPECT_EQ(norm(wrench_.force_n), 0);
  // The tool is as deep as before, so without the clutch it is felt again, 13 mm higher.
  pose.buttons = 0;
  EXPECT_TRUE(tick_until(pose, [&] { return std::abs(wrench_.force_n[2] - kServedN) < 0.1; }));
}

}  // namespace
}  // namespace kerf::agent::library_mapping_test
