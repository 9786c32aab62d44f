// SPDX-License-Identifier: Apache-2.0
// Pins and shown cameras, as several viewers see them.
#include <memory>
#include <string>
#include <vector>

#include "tests/server/whole/watcher.h"
#include "tests/server/whole/whole_server.h"

namespace kerf::test::together_test {
namespace {

class Together : public WholeServer {
 protected:
  Json set_pin(const std::string& text) {
    return made("POST", kPins + "?text=" + text + "&author=Ada&at_mm=1,2,0&normal=0,0,1");
  }
  /// Waits for the list of these pins.
  static void wait_for_pins(Watcher& viewer, const std::vector<std::string>& texts) {
    std::vector<std::string> sent;
    do {
      sent.clear();
      const Json list = viewer.receive("pins").at("pins");
      for (const Json& pin : list) sent.push_back(pin.at("text"));
    } while (sent != texts);
  }
  /// Waits for a list of `count` cameras.
  static Json cameras(Watcher& viewer, std::size_t count) {
    Json sent = viewer.receive("cameras").at("cameras");
    while (sent.size() != count) sent = viewer.receive("cameras").at("cameras");
    return sent;
  }
  const std::string kPins = "/v1/sessions/block/pins";
};

TEST_F(Together, ViewersSeePinsAtOnceAndAfterARestart) {
  auto first = std::make_unique<Watcher>(port), second = std::make_unique<Watcher>(port);
  const Json pin = set_pin("deep");
  EXPECT_EQ(pin.at("author"), "Ada");
  EXPECT_EQ(pin.at("at_mm"), Json({1, 2, 0}));
  EXPECT_EQ(pin.at("normal"), Json({0, 0, 1}));
  wait_for_pins(*first, {"deep"});
  {
    Watcher late(port);
    wait_for_pins(late, {"deep"});
  }
  set_pin("two");
  wait_for_pins(*second, {"deep", "two"});
  second->send({{"type", "seek"}, {"at", 0}});
  wait_for_pins(*second, {"deep", "two"});  // another block begins: the lists come again
  const std::string one = kPins + "/" + pin.at("pin").dump();
  made("DELETE", one);
  wait_for_pins(*first, {"two"});
  first.reset();
  second.reset();
  restart();
  const Json pins = made("GET", kPins).at("pins");
  ASSERT_EQ(pins.size(), 1U);
  EXPECT_EQ(pins.at(0).at("text"), "two");
  Watcher later(port);
  wait_for_pins(later, {"two"});
  EXPECT_EQ(error("DELETE", one), "404 unknown_pin");
}

TEST_F(Together, ACameraIsShownUntilItsViewerHidesItOrLeaves) {
  std::vector<std::unique_ptr<Watcher>> viewers;
  for (int n = 0; n < 9; ++n) {
    viewers.push_back(
        std::make_unique<Watcher>(port, Json{{"name", "Viewer " + std::to_string(n)}}));
  }
  Watcher &shows = *viewers.front(), &last = *viewers.back();
  Json pose = {{"type", "camera"}, {"eye_mm", {1, 2, 3}}, {"target_mm", {0, 0, 0}}};
  shows.send(pose);
  EXPECT_EQ(cameras(last, 1).at(0), Json({{"participant", shows.welcome.at("participant")},
                                          {"name", "Viewer 0"},
                                          {"color", shows.welcome.at("color")},
                                          {"eye_mm", {1, 2, 3}},
                                          {"target_mm", {0, 0, 0}},
                                          {"parallel", false}}));
  Json moved = pose;
  moved["parallel"] = true;
  for (int n = 0; n < 20; ++n) {
    moved["eye_mm"][0] = n;
    shows.send(moved);
  }
  while (cameras(last, 1).at(0).at("eye_mm").at(0) != 19) continue;
  Watcher late(port);
  EXPECT_EQ(cameras(late, 1).at(0).at("parallel"), true);
  for (int n = 1; n < 8; ++n) viewers[n]->send(pose);
  cameras(late, 8);
  last.send(pose);
  EXPECT_EQ(last.receive("error").at("code"), "busy");
  shows.send({{"type", "camera"}});
  cameras(late, 7);
  viewers[1].reset();
  cameras(late, 6);
}

}  // namespace
}  // namespace kerf::test::together_test
