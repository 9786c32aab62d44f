// SPDX-License-Identifier: Apache-2.0
#include "tests/server/api_rights_fixture.h"

namespace kerf::net::api_pins_test {
namespace {

TEST_F(ApiRightsTest, PinsAreSetBySculptorsAndSeenByWatchers) {
  const std::string pins = "/v1/sessions/block/pins";
  const std::string place = "&at_mm=1,2,-3&normal=0,0,2";
  const Json one =
      made("POST", pins + "?text=too%20deep&author=Ada" + place, tokens[Role::kSculptor], 201);
  EXPECT_EQ(one.at("pin"), 1);
  EXPECT_EQ(one.at("text"), "too deep");
  EXPECT_EQ(one.at("author"), "Ada");
  EXPECT_EQ(one.at("at_mm"), Json({1, 2, -3}));
  EXPECT_EQ(one.at("normal"), Json({0, 0, 1}));
  made("POST", pins + "?text=x" + place, tokens[Role::kWatcher], 403);
  const auto code = [&](const std::string& query) {
    return made("POST", pins + query, tokens[Role::kOwner], 400).at("error").at("code");
  };
  EXPECT_EQ(code("?text=" + place), "bad_text");
  EXPECT_EQ(code("?text=" + std::string(201, 'x') + place), "bad_text");
  EXPECT_EQ(code("?text=two%0Alines" + place), "bad_text");
  for (const char* bad : {"", "&at_mm=1,2,3", "&at_mm=1,2&normal=0,0,1",
                          "&at_mm=1,2,3,4&normal=0,0,1", "&at_mm=1,2,1e7&normal=0,0,1",
                          "&at_mm=1,2,3&normal=0,0,0", "&at_mm=1,2,nan&normal=0,0,1"}) {
    EXPECT_EQ(code("?text=x" + std::string(bad)), "bad_place") << bad;
  }
  EXPECT_EQ(code("?text=x&author=" + std::string(65, 'x') + place), "bad_name");
  const Json list = made("GET", pins, tokens[Role::kWatcher]).at("pins");
  ASSERT_EQ(list.size(), 1U);
  EXPECT_EQ(list[0].at("may_remove"), false);
  EXPECT_EQ(made("GET", pins, tokens[Role::kOwner]).at("pins")[0].at("may_remove"), true);
  made("DELETE", pins + "/1", tokens[Role::kSculptor], 403);
  made("DELETE", pins + "/x", tokens[Role::kOwner], 404);
  made("DELETE", pins + "/1", tokens[Role::kOwner]);
  EXPECT_EQ(made("DELETE", pins + "/1", tokens[Role::kOwner], 404).at("error").at("code"),
            "unknown_pin");
}

}  // namespace
}  // namespace kerf::net::api_pins_test
