// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "haptic_agent/link/control_message.h"
#include "haptic_agent/link/traffic.h"
#include "tests/agent/link/fake_server.h"

namespace kerf::agent {
namespace {

TEST(Control, ReachIsStatedIfTheServerTakesIt) {
  EXPECT_EQ(nlohmann::json::parse(hello_text({.name = "", .color = "", .reach = true}))["reach"],
            true);
  auto message = nlohmann::json::parse(welcome_text());
  EXPECT_FALSE(std::get<Welcome>(*parse_control(message.dump())).takes_reach);
  message["reach"] = true;
  EXPECT_TRUE(std::get<Welcome>(*parse_control(message.dump())).takes_reach);
  EXPECT_EQ(nlohmann::json::parse(reach_text({{1, 2, 3}, {4, 5, 6}, {0, 0, 0.5}, 0.1})),
            nlohmann::json::parse(R"({"type":"reach","center_mm":[1.0,2.0,3.0],
                "half_mm":[4.0,5.0,6.0],"turn_rad":[0.0,0.0,0.5],"scale":0.1})"));
}

TEST(TrafficReach, IsStatedWhenItChangesAndOnEachConnectionThatTakesIt) {
  SampleRing ring;
  LatestValue<ServerWrench> wrenches;
  LatestValue<Reach> reach;
  Traffic traffic(ring, wrenches, {.reach = &reach});
  Reach first{.center_mm = {1, 2, 3}, .half_mm = {4, 5, 6}}, second = first;
  second.center_mm.x = 9;
  traffic.begin(1, 0, 1000);
  reach.write(first);
  EXPECT_EQ(traffic.take_control(), "") << "the server has not offered to take it";
  traffic.offer_reach(true);
  EXPECT_EQ(traffic.take_control(), reach_text(first));
  EXPECT_EQ(traffic.take_control(), "");
  reach.write(second);
  EXPECT_EQ(traffic.take_control(), reach_text(second));
  traffic.begin(2, 0, 2000);
  traffic.offer_reach(true);
  EXPECT_EQ(traffic.take_control(), reach_text(second)) << "to the next server too";
  traffic.begin(3, 0, 3000);
  traffic.offer_reach(false);
  EXPECT_EQ(traffic.take_control(), "");
}

}  // namespace
}  // namespace kerf::agent
