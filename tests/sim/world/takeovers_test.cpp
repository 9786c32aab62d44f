// SPDX-License-Identifier: Apache-2.0
// Servers that share sessions: who runs which, without NATS, with a full disk, and from a snapshot.
#include <algorithm>
#include <string>
#include <vector>

#include "server/cluster/lease.h"
#include "server/cluster/snapshot_copy.h"
#include "tests/sim/nats/nats_model.h"
#include "tests/sim/world/cluster.h"

namespace kerf::sim::takeovers_test {
namespace {

using Takeovers = ClusterTest;

/// The sessions that a server lists, as "ID at NODE".
std::vector<std::string> listed(Cluster& servers, const std::string& at) {
  std::vector<std::string> found;
  const Json answer = Json::parse(servers.ask(at, "GET", "/v1/sessions").body);
  for (const Json& session : answer.at("sessions")) {
    found.push_back(session.at("id").get<std::string>() + " at " +
                    session.at("node").get<std::string>());
  }
  std::ranges::sort(found);
  return found;
}

std::string code_of(const HttpAnswer& answer) {
  return Json::parse(answer.body).at("error").at("code");
}

TEST_F(Takeovers, OfSeveralServersOneTakesASessionEachTime) {
  EXPECT_EQ(faults_of([](Cluster& servers) {
              for (const char* name : {"a", "b", "c"}) servers.start(name);
              const std::vector<std::string> sessions = {"block", "block1", "block2", "block3"};
              for (const std::string& session : sessions) servers.create("a", session);
              for (const std::string& session : sessions) servers.wait_for_copy("a", session);
              servers.kill("a");
              for (const std::string& session : sessions) {
                const std::string owner = servers.wait_for_owner(session);
                const std::string other = owner == "b" ? "c" : "b";
                EXPECT_EQ(servers.info(owner, session).at("epoch"), 3);
                EXPECT_TRUE(servers.until([&] {
                  const auto answer = servers.ask(other, "GET", "/v1/sessions/" + session);
                  return answer.status == 307 &&
                         answer.location == servers.address(owner) + "/v1/sessions/" + session;
                }));
              }
            }),
            "");
}

/// Once a request is answered, its change survives the loss of the server that answered.
TEST_F(Takeovers, AnAnsweredChangeIsAtTheServerThatContinues) {
  const std::string pins = "/v1/sessions/block/pins";
  EXPECT_EQ(faults_of([&](Cluster& servers) {
              servers.start("a");
              servers.create("a");
              servers.wait_for_copy("a");
              servers.start("b");
              const auto set = [&](const std::string& text) {
                return servers.ask("a", "POST",
                                   pins + "?text=" + text + "&at_mm=0,0,0&normal=0,0,1");
              };
              EXPECT_EQ(set("kept").status, 201);
              NatsModel::instance().cut_off(&servers.at("a").machine());
              const auto answer = set("lost");
              EXPECT_EQ(answer.status, 503);
              EXPECT_TRUE(answer.body.contains("not yet on another one")) << answer.body;
              servers.kill("a");
              EXPECT_EQ(servers.wait_for_owner(), "b");
              const Json left = Json::parse(servers.ask("b", "GET", pins).body).at("pins");
              ASSERT_EQ(left.size(), 1U);
              EXPECT_EQ(left.at(0).at("text"), "kept");
            }),
            "");
}

/// The claim of a session is stored at NATS, but its server fails before it starts the session.
TEST_F(Takeovers, ASessionThatWasNeverStartedIsEndedByTheServerThatClaimedIt) {
  const auto lease_of_ghost = [] {
    const auto last =
        NatsConnection::open("", "test")->last_message(kClusterStream, lease_subject("ghost"));
    return decode_lease((*last)->bytes).value();
  };
  EXPECT_EQ(faults_of([&](Cluster& servers) {
              servers.start("b");
              servers.create("b");
              const Lease claim{.node = "a",
                                .run = "1",
                                .address = "http://127.0.0.1:1",
                                .epoch = 1,
                                .to = {},
                                .shown = {}};
              EXPECT_TRUE(NatsConnection::open("", "test")
                              ->publish(lease_subject("ghost"), encode_lease(claim), "ghost/1", 0));
              sleep_until(now() + 12 * kSecond);
              EXPECT_EQ(lease_of_ghost().node, "a") << "b cannot open it";
              EXPECT_EQ(lease_of_ghost().epoch, 1U);
              EXPECT_EQ(servers.ask("b", "GET", "/v1/sessions/ghost").status, 503);
              servers.start("a");
              EXPECT_TRUE(servers.until([&] {
                return servers.ask("b", "GET", "/v1/sessions/ghost").status == 404 &&
                       servers.ask("a", "GET", "/v1/sessions/ghost").status == 404;
              }));
              EXPECT_EQ(lease_of_ghost().state, LeaseState::kClosed);
            }),
            "");
}

/// A NATS that has lost messages names the former owner, which has stopped. The server that has
/// continued the session takes it again, and ends its former session first: two would write one
/// journal, and hands at the former one would wait for ever.
TEST_F(Takeovers, AServerThatTakesItsOwnSessionAgainEndsTheFormerOne) {
  EXPECT_EQ(faults_of([](Cluster& servers) {
              servers.start("b");
              servers.create("b");
              servers.carve("b");
              servers.wait_for_copy("b");
              servers.stop("b");
              const NatsStore old = NatsModel::instance().store();
              servers.start("a");
              EXPECT_EQ(servers.wait_for_owner(), "a");
              servers.begin_carving("a", 6 * kSecond);
              sleep_until(now() + kSecond);
              NatsModel::instance().stop();
              NatsModel::instance().set_store(old);
              NatsModel::instance().start();
              servers.finish_carving();
              EXPECT_EQ(servers.wait_for_owner(), "a");
              EXPECT_GE(servers.info("a").at("epoch"), 4);
              servers.check_journal("a");
            }),
            "");
}

/// NATS tells the former owner of its successor only after it has read what its agent has sent.
TEST_F(Takeovers, AStoppedOwnerThatIsContinuedChangesNothingBeforeItKnows) {
  EXPECT_EQ(
      faults_of([](Cluster& servers) {
        servers.start("a");
        servers.create("a");
        servers.carve("a");
        servers.wait_for_copy("a");
        servers.start("b");
        servers.begin_carving("a", 8 * kSecond);
        sleep_until(now() + kSecond);
        servers.at("a").stand_still(6 * kSecond);
        NatsModel::instance().cut_off(&servers.at("a").machine());
        EXPECT_EQ(servers.wait_for_owner(), "b");
        while (servers.at("a").machine().stands_until > now()) {
          sleep_until(now() + 50 * kMillisecond);
          EXPECT_EQ(servers.wait_for_owner(), "b");
        }
        sleep_until(now() + kSecond);
        EXPECT_EQ(servers.info("a").at("paused"), "lease");
        EXPECT_EQ(servers.wait_for_owner(), "b");
        NatsModel::instance().let_in(&servers.at("a").machine());
        const std::string target = "/v1/sessions/block/strokes?since=1";
        EXPECT_TRUE(servers.until([&] { return servers.ask("a", "GET", target).status == 307; }));
        EXPECT_EQ(servers.ask("a", "GET", target).location, servers.address("b") + target);
        servers.finish_carving();
        servers.check_journal("b");
        servers.wait_for_copy("b");
        EXPECT_TRUE(servers.is_copied_as_it_is("b"));
      }),
      "");
}

TEST_F(Takeovers, WithoutNatsTheSessionPausesAndGoesOnByItself) {
  EXPECT_EQ(faults_of([](Cluster& servers) {
              servers.start("a");
              servers.create("a");
              servers.start("b");
              servers.carve("a");
              const Json before = servers.info("a");
              NatsModel::instance().stop();
              EXPECT_TRUE(servers.until([&] { return servers.info("a").at("paused") == "lease"; }));
              const Json ready = Json::parse(servers.ask("a", "GET", "/readyz").body);
              EXPECT_EQ(ready.at("paused"), Json::array({"block"}));
              const auto refused = servers.ask("a", "POST", "/v1/sessions?id=other", kScene);
              EXPECT_EQ(refused.status, 503);
              EXPECT_EQ(code_of(refused), "no_lease");
              servers.begin_carving("a", 2 * kSecond);
              sleep_until(now() + 3 * kSecond);
              EXPECT_EQ(servers.info("a").at("motions"), before.at("motions"));
              NatsModel::instance().start();
              const std::string owner = servers.wait_for_owner();
              if (owner == "a") {
                EXPECT_EQ(servers.info("a").at("epoch"), before.at("epoch"));
              }
              servers.finish_carving();
              servers.check_journal(servers.wait_for_owner());
            }),
            "");
}

TEST_F(Takeovers, AnOwnerWhoseDiskIsFullKeepsItsSessionUntilItIsGone) {
  EXPECT_EQ(faults_of([](Cluster& servers) {
              servers.start("a");
              servers.create("a");
              servers.start("b");
              servers.carve("a");
              servers.at("a").disk().state = DiskState::kFull;
              servers.at("a").disk().free_bytes = 0;
              servers.begin_carving("a", kSecond);
              EXPECT_TRUE(servers.until([&] { return servers.info("a").at("paused") == "disk"; }));
              for (int n = 0; n < 40; ++n) {  // longer than its lease lasts without a renewal
                sleep_until(now() + 250 * kMillisecond);
                EXPECT_EQ(servers.ask("b", "GET", "/v1/sessions/block").status, 307);
              }
              EXPECT_EQ(servers.info("a").at("paused"), "disk");
              servers.kill("a");
              EXPECT_EQ(servers.wait_for_owner(), "b");
              servers.finish_carving();
              servers.check_journal("b");
            }),
            "");
}

TEST_F(Takeovers, AnyServerListsAllSessionsAndNoneGetsASecondOneOfAnId) {
  EXPECT_EQ(faults_of([](Cluster& servers) {
              for (const char* name : {"a", "b"}) servers.start(name);
              servers.create("a", "block");
              servers.create("b", "other");
              const std::vector<std::string> both = {"block at a", "other at b"};
              for (const char* name : {"a", "b"}) {
                EXPECT_TRUE(servers.until([&] { return listed(servers, name) == both; })) << name;
              }
              // `here`: never at the one with fewer sessions.
              const auto again = [&] {
                return servers.ask("b", "POST", "/v1/sessions?id=block&here=1", kScene);
              };
              EXPECT_EQ(again().status, 409);
              EXPECT_EQ(code_of(again()), "session_exists");
              EXPECT_EQ(servers.ask("a", "DELETE", "/v1/sessions/block").status, 200);
              EXPECT_TRUE(servers.until(
                  [&] { return servers.ask("b", "GET", "/v1/sessions/block").status == 404; }));
              EXPECT_EQ(again().status, 503);
              EXPECT_EQ(code_of(again()), "no_lease");
              EXPECT_TRUE(again().body.contains("kerf-server forget block"));
            }),
            "");
}

/// Otherwise another server would continue it after its owner has answered that it is closed.
TEST_F(Takeovers, ASessionClosesOnlyWhenItsEndIsStoredAtNats) {
  for (const char* purge : {"", "?purge=1"}) {
    EXPECT_EQ(faults_of([&](Cluster& servers) {
                for (const char* name : {"a", "b"}) servers.start(name);
                servers.create("a");
                servers.carve("a");
                servers.wait_for_copy("a");
                const Json before = servers.info("a");
                const std::string target = std::string("/v1/sessions/block") + purge;
                NatsModel::instance().stop();
                const auto refused = servers.ask("a", "DELETE", target);
                EXPECT_EQ(refused.status, 503);
                EXPECT_EQ(code_of(refused), "no_lease");
                EXPECT_EQ(servers.info("a").at("motions"), before.at("motions"));
                NatsModel::instance().start();
                servers.wait_for_owner();
                EXPECT_TRUE(servers.until(
                    [&] { return servers.ask("a", "DELETE", target).status == 200; }));
                sleep_until(now() + 10 * kSecond);  // longer than a lease lasts
                for (const char* name : {"a", "b"}) EXPECT_EQ(listed(servers, name).size(), 0u);
              }),
              "");
  }
}

TEST_F(Takeovers, ANewSessionGoesToTheServerWithTheFewest) {
  EXPECT_EQ(faults_of([](Cluster& servers) {
              for (const char* name : {"a", "b", "c"}) servers.start(name);
              servers.create("a", "block");
              const auto has = [&](std::size_t count) {
                return servers.until([&] { return listed(servers, "a").size() == count; });
              };
              EXPECT_TRUE(has(1));
              const auto make = [&](const std::string& query, const std::string& fields = {}) {
                return servers.ask("a", "POST", "/v1/sessions?id=" + query, kScene, fields);
              };
              EXPECT_TRUE(servers.until([&] {
                return servers.at("a").server()->sessions().find("block")->other_servers().size() ==
                       2;
              }));
              std::vector<std::string> places;
              for (const char* id : {"one", "two"}) {
                const auto sent = make(id);
                EXPECT_EQ(sent.status, 307);
                EXPECT_EQ(code_of(sent), "other_server");
                EXPECT_TRUE(sent.location.contains("here=1")) << sent.location;
                for (const char* name : {"b", "c"}) {
                  if (!sent.location.starts_with(servers.address(name) + "/")) continue;
                  places.emplace_back(name);
                  servers.create(name, id);
                }
                EXPECT_TRUE(has(1 + places.size()));
              }
              std::ranges::sort(places);
              EXPECT_EQ(places, (std::vector<std::string>{"b", "c"}));
              EXPECT_EQ(make("three&here=0").status, 201) << "all have as many";
              // A page's script may not follow to another origin: it gets its session where it
              // asks.
              EXPECT_TRUE(has(4));
              EXPECT_EQ(make("page", "Origin: " + servers.address("a") + "\r\n").status, 201);
            }),
            "");
}

TEST_F(Takeovers, ATakeoverBeginsWithTheCopiedSnapshotAndADamagedOneCostsOnlyTime) {
  EXPECT_EQ(
      faults_of([](Cluster& servers) {
        const auto often = [](net::ServerOptions& options) {
          options.snapshots = {.replay_time = std::chrono::microseconds(0),
                               .age = std::chrono::seconds(2),
                               .pause = std::chrono::milliseconds(100)};
        };
        servers.start("a", often);
        servers.create("a");
        servers.carve("a", 2 * kSecond);
        servers.wait_for_copy("a");
        const Json before = servers.block("a");
        EXPECT_TRUE(
            servers.until([&] { return servers.info("a").at("copied").at("snapshot") > 100; }));
        servers.start("b");
        servers.kill("a");
        EXPECT_EQ(servers.wait_for_owner(), "b");
        EXPECT_EQ(servers.block("b"), before);
        EXPECT_TRUE(std::filesystem::exists(servers.file("b", "block.kerf-snapshot")));
        auto nats = NatsConnection::open("", "test");
        const std::vector<std::byte> none(11);
        const auto last = nats->last_message(snapshot_stream("block"), snapshot_subject("block"));
        ASSERT_TRUE(last && *last);
        ASSERT_TRUE(nats->publish(snapshot_subject("block"), none, "none", (*last)->sequence));
        servers.start("c");
        servers.kill("b");
        EXPECT_EQ(servers.wait_for_owner(), "c");
        EXPECT_EQ(servers.block("c"), before);
        servers.check_journal("c");
      }),
      "");
}

}  // namespace
}  // namespace kerf::sim::takeovers_test
