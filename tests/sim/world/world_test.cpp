// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/world/world.h"

#include <gtest/gtest.h>

#include "tests/server/temporary_folder.h"
#include "tests/sim/world/process.h"

namespace kerf::sim {
namespace {

class WorldTest : public testing::Test {
 protected:
  /// Runs a plan under some seeds; the faults of all.
  std::string faults_of(Plan plan, std::uint64_t seeds = 3) const {
    std::string faults;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      plan.seed = seed;
      faults += run_world(plan, folder_ / std::to_string(seed)).faults;
    }
    return faults;
  }

  const test::TemporaryFolder folder_;
};

TEST_F(WorldTest, NothingIsLostWithoutFaults) {
  Plan plan;
  plan.pages = 1;
  EXPECT_EQ(faults_of(plan), "");
  plan.servers = 2;
  plan.follows = true;
  EXPECT_EQ(faults_of(plan), "");
}

}  // namespace
}  // namespace kerf::sim
