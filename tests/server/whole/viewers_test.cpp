// SPDX-License-Identifier: Apache-2.0
// Tiles for viewers: levels of detail, budgets of bandwidth, and crowds.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <future>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/server/whole/hand.h"
#include "tests/server/whole/watcher.h"
#include "tests/server/whole/whole_server.h"

namespace kerf::test::viewers_test {
namespace {

using Clock = std::chrono::steady_clock;

const Json kAfar = {{"eye_mm", {0, 0, 1e5}}, {"error_rad", 0.01}};

class Viewers : public WholeServer {
 protected:
  void carve(int steps, double phase = 0) const { Hand(port).carve(steps, phase); }
};

TEST_F(Viewers, SettleOnTheStateHash) {
  Watcher early(port);
  early.settled(hash());
  EXPECT_EQ(early.tiles.size(), 9U) << "80 columns a side are 3 x 3 tiles";
  carve(200);
  Watcher late(port);
  std::uint64_t newest = 0;
  for (Watcher* viewer : {&early, &late}) {
    viewer->settled(hash());
    EXPECT_EQ(viewer->tiles.size(), 9U);
  }
  for (const auto& [place, tile] : early.tiles) newest = std::max(newest, tile.version);
  EXPECT_GT(newest, 1U);
}

TEST_F(Viewers, DistantOnesGetCoarseTilesAndNearOnesExactTiles) {
  carve(200);
  Watcher near(port), far(port, {{"name", "Far"}});
  const auto look = [&](double error_rad) {
    far.send({{"type", "look"}, {"eye_mm", {0, 0, 1e5}}, {"error_rad", error_rad}});
  };
  look(0.01);
  while (far.tiles.size() != 9 || !far.has_levels_only(3)) far.take();
  near.settled();
  EXPECT_TRUE(near.has_levels_only(0));
  look(0);
  while (!far.has_levels_only(0)) far.take();
  for (int n = 0; n < 40; ++n) look(0);
  EXPECT_EQ(far.receive("error").at("code"), "too_fast");
}

TEST_F(Viewers, FirstTilesFollowTheFirstLook) {
  carve(100);
  Watcher known(port, {{"look", kAfar}}), later(port, {{"look", true}});
  Json look = kAfar;
  look["type"] = "look";
  later.send(look);
  for (Watcher* viewer : {&known, &later}) {
    viewer->settled();
    EXPECT_EQ(viewer->received, 9U);
    EXPECT_TRUE(viewer->has_levels_only(3));
  }
  Watcher silent(port, {{"look", true}});
  silent.settled();
  EXPECT_EQ(silent.received, 9U);
  EXPECT_TRUE(silent.has_levels_only(0));
}

TEST_F(Viewers, MeshFramesStateTheirMotions) {
  carve(50);
  Watcher eve(port);
  const std::uint64_t motions = eve.settled().at("motions");
  EXPECT_GE(motions, 49U);
  EXPECT_EQ(eve.motions, motions);
  carve(50, 2);
  while (eve.motions <= motions) eve.take();
}

/// A watcher that measures by how much received bytes exceed its budget.
class CountedWatcher : public Watcher {
 public:
  CountedWatcher(std::uint16_t port, double bytes_per_s, const Json& hello = Json::object())
      : CountedWatcher(Clock::now(), port, bytes_per_s, hello) {}
  void take() {
    const std::size_t before = mesh_bytes;
    if (Watcher::take() != "mesh" || mesh_bytes == before) return;
    const double passed = std::chrono::duration<double>(Clock::now() - begin_).count();
    most = std::max(
        most, static_cast<double>(mesh_bytes) - kTileBytes - bytes_per_s_ * (passed + kBurstS));
  }
  void settle(const std::string& hash) {
    while (last.value("type", "") != "state" || !last.at("settled").get<bool>() ||
           last.at("state_hash") != hash) {
      take();
    }
  }
  double most = -INFINITY;

 private:
  // Maximum size of a tile in a frame, and the burst and step of the server's budget.
  static constexpr double kTileBytes = 30'000, kBurstS = 0.55;
  CountedWatcher(Clock::time_point begin, std::uint16_t port, double bytes_per_s, const Json& hello)
      : Watcher(port, hello), begin_(begin), bytes_per_s_(bytes_per_s) {}
  Clock::time_point begin_;  ///< before it has joined
  double bytes_per_s_;
};

/// A block of two tiles, small enough for the smallest budget.
class Budgets : public Viewers {
 protected:
  void SetUp() override {
    start();
    create("block",
           scene_with({{"stock",
                        {{"shape", "box"}, {"min_mm", {-12, -6, -20}}, {"max_mm", {12, 6, 0}}}}}));
  }
  /// Cuts across the whole block, deeper and deeper, until `done`. Each cut follows a message to
  /// the viewers: however slow they are, some stock is left.
  template <typename Done>
  void watch(const std::vector<CountedWatcher*>& viewers, Done done) {
    Hand hand(port);
    for (int step = 0; !done();) {
      std::vector<Vec3> tips;
      for (const int last = step + 8; step < last; ++step) {
        const double angle = step * 0.2, radius = 10 * std::fabs(std::sin(step * 0.013));
        tips.push_back({radius * std::cos(angle), radius * std::sin(angle), -1 - step * 0.002});
      }
      hand.move(tips);
      hand.result();
      for (CountedWatcher* viewer : viewers) viewer->take();
    }
    for (CountedWatcher* viewer : viewers) viewer->settle(hash());
  }
};

TEST_F(Budgets, AreNeverExceededAndTheFinalStateIsExact) {
  CountedWatcher free(port, INFINITY), bound(port, 25'000, {{"budget", 25'000}});
  EXPECT_FALSE(free.welcome.contains("budget"));
  EXPECT_EQ(bound.welcome.at("budget"), 25'000);
  watch({&bound, &free}, [&] { return free.mesh_bytes > 200'000 && bound.coarse > 0; });
  EXPECT_LE(bound.most, 0);
  EXPECT_EQ(free.coarse, 0U);
  EXPECT_TRUE(bound.has_levels_only(0));
  EXPECT_EQ(bound.tiles.size(), free.tiles.size());
  // The budget also applies to the past.
  const std::string now = hash();
  bound.send({{"type", "seek"}, {"at", info().at("motions").get<int>() / 2}});
  while (!bound.last.contains("at")) bound.take();
  while (bound.last.value("type", "") != "state" || !bound.last.at("settled").get<bool>()) {
    bound.take();
  }
  EXPECT_TRUE(bound.has_levels_only(0));
  bound.send({{"type", "seek"}, {"at", "live"}});
  bound.receive("welcome");
  bound.settle(now);
  EXPECT_LE(bound.most, 0);
}

TEST_F(Budgets, AreRemovedByALook) {
  CountedWatcher eve(port, 25'000, {{"budget", 25'000}});
  Json look = {{"type", "look"}, {"eye_mm", {0, 0, 500}}, {"error_rad", 0}, {"budget", 24'999}};
  eve.send(look);
  EXPECT_EQ(eve.receive("error").at("code"), "bad_message");
  look["budget"] = 0;
  eve.send(look);
  watch({&eve}, [&] { return eve.most > 0; });
}

TEST_F(Budgets, AreCappedByTheServer) {
  options.viewer_budget = 50'000;
  restart();
  const std::pair<Json, int> cases[] = {{Json::object(), 50'000},
                                        {{{"budget", 0}}, 50'000},
                                        {{{"budget", 900'000}}, 50'000},
                                        {{{"budget", 30'000}}, 30'000}};
  for (const auto& [hello, budget] : cases) {
    CountedWatcher eve(port, budget, hello);
    EXPECT_EQ(eve.welcome.at("budget"), budget) << hello;
    eve.settle(hash());
    EXPECT_LE(eve.most, 0) << hello;
  }
}

class Crowd : public Viewers {
 protected:
  static constexpr std::size_t kViewers = 200;
  /// A list of 200 names for each of 200 viewers takes 3 MB.
  static constexpr std::size_t kTextBytesMax = 600'000;

  std::unique_ptr<Watcher> come(std::size_t number, const Json& more = Json::object()) const {
    Json hello = {{"name", "viewer " + std::to_string(number)}};
    hello.update(more);
    return std::make_unique<Watcher>(port, hello);
  }
  /// Changes the tool continually until `stop`.
  void change_tools(const std::atomic<bool>& stop) const {
    Hand hand(port);
    for (int n = 0; !stop; ++n) {
      hand.send({{"type", "tool"}, {"tool", 1 + n % 2}});
      hand.move({{0, 0, 30}}, {.cuts = false});
      hand.result();  // so that its answers are read
    }
  }
  /// Follows lists and changes until all other viewers have left. Returns the number of carvers
  /// left.
  static std::size_t carvers_in_the_end(Watcher& viewer) {
    std::map<int, std::string> people;
    const auto take = [&](const Json& list) {
      for (const Json& one : list) people[one.at("participant")] = one.at("kind");
    };
    take(viewer.welcome.at("participants"));
    std::size_t count = viewer.welcome.at("viewers");
    const auto has_agent = [&] {
      return std::ranges::any_of(people, [](const auto& one) { return one.second == "agent"; });
    };
    while (count != kViewers || has_agent()) {
      const std::string type = viewer.take();
      if (type == "participants") {
        people.clear();
        take(viewer.last.at("participants"));
      } else if (type == "participants_changed") {
        take(viewer.last.value("changed", Json::array()));
        for (const Json& left : viewer.last.value("left", Json::array())) people.erase(left);
      } else {
        continue;
      }
      count = viewer.last.at("viewers");
    }
    return people.size();
  }
};

TEST_F(Crowd, LateReadersAreKeptAndCostLittleText) {
  std::atomic<bool> stop = false;
  auto changing = std::async(std::launch::async, [&] { change_tools(stop); });
  std::vector<std::unique_ptr<Watcher>> viewers;
  for (std::size_t n = 0; n < kViewers; ++n) {
    viewers.push_back(come(n, {{"changes", n % 2 == 0}}));
  }
  stop = true;
  changing.get();
  std::size_t text = 0;
  for (const auto& viewer : viewers) {  // a dropped viewer throws
    EXPECT_EQ(carvers_in_the_end(*viewer), 0U);
    text += viewer->text_bytes();
  }
  EXPECT_LT(text, kTextBytesMax);
  EXPECT_EQ(info().at("participants").size(), kViewers);
}

TEST_F(Crowd, GetsTheLastPosesAndTiles) {
  std::vector<std::unique_ptr<Watcher>> viewers;
  for (std::size_t n = 0; n < 60; ++n) viewers.push_back(come(n));
  Hand ada(port);
  std::vector<Vec3> tips;
  for (int n = 0; n < 12; ++n) tips.push_back({0.1 * n, 1, -2});
  ada.move(tips);
  ada.move({{1, 2, 3}}, {.cuts = false});  // no tile changes
  ada.result();
  const std::string now = hash();
  for (const auto& viewer : viewers) {
    viewer->settled(now);
    EXPECT_EQ((viewer->tiles[{0, 0}].version), (viewers[0]->tiles[{0, 0}].version));
    while (viewer->tools.empty() || viewer->tools[0].tip_mm.z != 3) viewer->take();
  }
}

}  // namespace
}  // namespace kerf::test::viewers_test
