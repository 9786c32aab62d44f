// SPDX-License-Identifier: Apache-2.0
// Servers that follow the sessions of another one.
#include <set>
#include <string>

#include "tests/sim/nats/nats_model.h"
#include "tests/sim/world/cluster.h"

namespace kerf::sim::followers_test {
namespace {

class SimFollowers : public ClusterTest {
 protected:
  static Cluster::Change follows(Follow follow) {
    return [follow](net::ServerOptions& options) { options.cluster.follow = follow; };
  }
  /// Server a with a carved block, and b that follows it.
  static void begin(Cluster& servers, Follow follow = Follow::kViewed) {
    servers.start("a");
    servers.create("a");
    servers.carve("a");
    // What has no copy yet cannot be followed, and is tried again after seconds only.
    servers.wait_for_copy("a");
    servers.start("b", follows(follow));
    wait_until_equal(servers);
  }
  static void wait_until_equal(Cluster& servers, const std::string& owner = "a") {
    EXPECT_TRUE(servers.until([&] {
      const Json block = servers.block("b");
      return block.is_array() && block == servers.block(owner) &&
             servers.info("b").at("followed") == true;
    }));
  }
  static std::uint64_t hash(Cluster& servers, const std::string& at) {
    return std::stoull(servers.info(at).at("state_hash").get<std::string>(), nullptr, 16);
  }
  static std::set<std::string> names(Cluster& servers, const std::string& at) {
    std::set<std::string> found;
    const Json info = servers.info(at);
    if (!info.is_object()) return found;
    for (const Json& one : info.at("participants")) found.insert(one.at("name"));
    return found;
  }
};

TEST_F(SimFollowers, OneThatOnlyFollowsShowsSessionsAndRunsNone) {
  EXPECT_EQ(faults_of([](Cluster& servers) {
              begin(servers, Follow::kOnly);
              EXPECT_TRUE(servers.until([&] {
                const auto sent = servers.ask("b", "POST", "/v1/sessions", kScene);
                return sent.location == servers.address("a") + "/v1/sessions?here=1";
              }));
              const auto refused = servers.ask("b", "POST", "/v1/sessions?here=1&id=x", kScene);
              EXPECT_EQ(refused.status, 503);
              EXPECT_TRUE(refused.body.contains("no_lease")) << refused.body;
              EXPECT_TRUE(refused.body.contains("only follows")) << refused.body;
              const Json before = servers.block("a");
              servers.kill("a");
              // The lease is free, and has been for as long as it took the third server to get it.
              servers.start("c");
              EXPECT_EQ(servers.wait_for_owner(), "c");
              EXPECT_TRUE(servers.until([&] { return servers.block("b") == before; }));
              EXPECT_EQ(servers.info("b").at("followed"), true);
            }),
            "");
}

TEST_F(SimFollowers, WhatOnlyLooksIsAnsweredThereAndTheRestIsSentToTheOwner) {
  EXPECT_EQ(
      faults_of([](Cluster& servers) {
        begin(servers);
        const std::string url = "/v1/sessions/block/";
        EXPECT_EQ(servers.ask("a", "POST", url + "versions?name=first").status, 201);
        EXPECT_EQ(servers.ask("a", "POST", url + "pins?text=here&at_mm=0,0,0&normal=0,0,1").status,
                  201);
        wait_until_equal(servers);
        for (const char* path : {"model.stl", "model.glb", "program.ngc", "forces.csv", "strokes",
                                 "versions", "pins", "picture.png", "journal"}) {
          const auto expected = servers.ask("a", "GET", url + path);
          EXPECT_EQ(expected.status, 200) << path;
          EXPECT_TRUE(servers.until([&] {
            return servers.ask("b", "GET", url + path).body == expected.body;
          })) << path;
        }
        for (const auto& [method, path] :
             {std::pair("POST", "/undo"), std::pair("POST", "/pins"), std::pair("GET", "/programs"),
              std::pair("DELETE", "")}) {
          const auto sent = servers.ask("b", method, std::string("/v1/sessions/block") + path);
          EXPECT_EQ(sent.status, 307) << path;
          EXPECT_TRUE(sent.location.starts_with(servers.address("a") + "/")) << path;
        }
        servers.carve("b");  // its link is sent on
        wait_until_equal(servers);
        servers.check_journal("a");
      }),
      "");
}

TEST_F(SimFollowers, ViewersThereSeeWhoCarvesAndAreCountedAtTheOwner) {
  EXPECT_EQ(faults_of([](Cluster& servers) {
              begin(servers);
              const auto viewers = [&] {
                const auto session = servers.at("a").server()->sessions().find("block");
                return session->roster().viewers;
              };
              Page page("block", {servers.at("b").port()}, 7);
              page.start();
              servers.begin_carving("a", 2 * kSecond);
              EXPECT_TRUE(servers.until([&] { return names(servers, "b").contains("hand 1"); }));
              EXPECT_TRUE(servers.until([&] { return viewers() == 1; }));
              servers.finish_carving();
              EXPECT_TRUE(servers.until([&] { return !names(servers, "b").contains("hand 1"); }));
              wait_until_equal(servers);
              EXPECT_TRUE(page.shows(hash(servers, "a"), 10 * kSecond));
              page.stop();
              EXPECT_TRUE(servers.until([&] { return viewers() == 0; }));
            }),
            "");
}

TEST_F(SimFollowers, TheyShowTheSameBlockThroughUndoAndRedo) {
  EXPECT_EQ(faults_of([](Cluster& servers) {
              begin(servers);
              Page page("block", {servers.at("b").port()}, 7);
              page.start();
              const auto change = [&](const char* what, int participant) {
                const auto answer = servers.ask("a", "POST",
                                                std::string("/v1/sessions/block/") + what +
                                                    "?participant=" + std::to_string(participant));
                EXPECT_EQ(answer.status / 100, 2) << answer.body;
              };
              for (int n = 1; n <= 3; ++n) {
                servers.carve("a", 300 * kMillisecond);
                change("undo", n);
                if (n == 2) change("redo", n);
                wait_until_equal(servers);
                EXPECT_TRUE(page.shows(hash(servers, "a"), 10 * kSecond));
              }
              page.stop();
            }),
            "");
}

TEST_F(SimFollowers, TheyGoOnWhenTheOwnerIsKilledAndNothingIsLost) {
  EXPECT_EQ(faults_of([](Cluster& servers) {
              servers.start("a", follows(Follow::kAll));
              servers.create("a");
              servers.carve("a");
              servers.wait_for_copy("a");
              servers.start("b", follows(Follow::kAll));
              wait_until_equal(servers);
              servers.begin_carving("a", 8 * kSecond);
              for (const auto& [owner, heir] : {std::pair("a", "b"), std::pair("b", "a")}) {
                sleep_until(now() + kSecond);
                servers.kill(owner);
                EXPECT_EQ(servers.wait_for_owner(), heir);
                servers.start(owner);
                EXPECT_TRUE(servers.until([&, one = std::string(owner)] {
                  const Json info = servers.info(one);
                  return info.is_object() && info.at("followed") == true;
                }));
              }
              servers.finish_carving();
              servers.check_journal("a");
            }),
            "");
}

TEST_F(SimFollowers, TheyFollowOnWhenTheSessionMovesAndWhenNatsComesBack) {
  EXPECT_EQ(faults_of([](Cluster& servers) {
              begin(servers);
              servers.create("b", "other");  // so c has the fewest sessions
              servers.start("c");
              EXPECT_TRUE(servers.until([&] {
                const auto session = servers.at("a").server()->sessions().find("block");
                return session->other_servers().size() == 2;
              }));
              Page page("block", {servers.at("b").port()}, 7);
              page.start();
              servers.begin_carving("a", 2 * kSecond);
              sleep_until(now() + kSecond);
              servers.stop("a");
              EXPECT_EQ(servers.wait_for_owner(), "c");
              servers.finish_carving();
              wait_until_equal(servers, "c");
              NatsModel::instance().stop();
              servers.begin_carving("c", 500 * kMillisecond);  // cut, and not copied
              EXPECT_TRUE(servers.until([&] {
                const Json fault = servers.info("c").at("copied").at("fault");
                return fault.is_string() && fault.get<std::string>().contains("cannot be reached");
              }));
              NatsModel::instance().start();  // while the lease lasts
              EXPECT_EQ(servers.wait_for_owner(), "c");
              servers.finish_carving();
              wait_until_equal(servers, "c");
              EXPECT_TRUE(page.shows(hash(servers, "c"), 10 * kSecond));
              page.stop();
              servers.check_journal("c");
            }),
            "");
}

TEST_F(SimFollowers, AFollowedSessionEndsWithTheSession) {
  EXPECT_EQ(faults_of([](Cluster& servers) {
              begin(servers);
              Page page("block", {servers.at("b").port()}, 7);
              page.start();
              EXPECT_TRUE(page.shows(hash(servers, "a"), 10 * kSecond));
              EXPECT_EQ(servers.ask("a", "DELETE", "/v1/sessions/block").status, 200);
              EXPECT_TRUE(servers.until(
                  [&] { return servers.ask("b", "GET", "/v1/sessions/block").status == 404; }));
              sleep_until(now() + kSecond);
              page.stop();
              ASSERT_FALSE(page.byes().empty());
              EXPECT_EQ(page.byes().front(), "the session has ended");
            }),
            "");
}

}  // namespace
}  // namespace kerf::sim::followers_test
