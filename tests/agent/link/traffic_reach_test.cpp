// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "haptic_agent/link/control_message.h"
#include "haptic_agent/link/traffic.h"
#include "tests/agent/link/fake_server.h"
#include "tests/support/test.h"

namespace kerf::agent::traffic_reach_test {
namespace {

TEST(Control, ReachIsSentIfTheServerAcceptsIt) {
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

TEST(TrafficReach, IsSentOnEachChangeAndOnEachConnectionThatAcceptsIt) {
  SampleRing ring;
  LatestValue<ServerWrench> wrenches;
  LatestValue<Reach> reach;
  Traffic traffic(ring, wrenches, {.reach = &reach});
  Reach first{.center_mm = {1, 2, 3}, .half_mm = {4, 5, 6}}, second = first;
  second.center_mm.x = 9;
  constexpr std::uint64_t kEveryUs = 100'000;
  std::uint64_t now_us = 1'000'000;
  traffic.begin(1, 0, now_us);
  reach.write(first);
  EXPECT_EQ(traffic.take_control(now_us), "") << "the server has not offered to take it";
  traffic.offer_reach(true);
  EXPECT_EQ(traffic.take_control(now_us), reach_text(first));
  EXPECT_EQ(traffic.take_control(now_us + kEveryUs), "") << "it has not changed";
  reach.write(second);
  EXPECT_EQ(traffic.take_control(now_us += kEveryUs), reach_text(second));
  traffic.begin(2, 0, now_us += 1000);
  traffic.offer_reach(true);
  EXPECT_EQ(traffic.take_control(now_us), reach_text(second)) << "to the next server, at once";
  traffic.begin(3, 0, now_us += 1000);
  traffic.offer_reach(false);
  EXPECT_EQ(traffic.take_control(now_us), "");
}

TEST(TrafficReach, IsSentAtMostTenTimesPerSecondIncludingTheLastChange) {
  SampleRing ring;
  LatestValue<ServerWrench> wrenches;
  LatestValue<Reach> reach;
  Traffic traffic(ring, wrenches, {.reach = &reach});
  std::uint64_t now_us = 1'000'000, last_us = 0;
  traffic.begin(1, 0, now_us);
  traffic.offer_reach(true);
  std::vector<std::string> stated;
  const auto look = [&] {
    now_us += 1000;
    std::string text = traffic.take_control(now_us);
    if (text.empty()) return;
    EXPECT_GE(now_us - last_us, 100'000U);
    last_us = now_us;
    stated.push_back(std::move(text));
  };
  Reach newest{.half_mm = {4, 5, 6}};
  for (int i = 0; i < 250; ++i) {
    newest.center_mm.x = i;
    reach.write(newest);
    look();
  }
  ASSERT_EQ(stated.size(), 3U) << "at once, and after 100 and 200 ms";
  EXPECT_NE(stated.back(), reach_text(newest)) << "the last change is still to come";
  for (int i = 0; i < 500; ++i) look();
  ASSERT_EQ(stated.size(), 4U);
  EXPECT_EQ(stated.back(), reach_text(newest));
}

}  // namespace
}  // namespace kerf::agent::traffic_reach_test
