// SPDX-License-Identifier: Apache-2.0
// Journals are copied to NATS while they are written, by servers that share no sessions.
#include "server/cluster/copies.h"

#include <cmath>
#include <cstring>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "server/store/journal_change.h"
#include "server/store/sqlite.h"
#include "tests/sim/nats/nats_model.h"
#include "tests/sim/world/cluster.h"

namespace kerf::sim::copies_test {
namespace {

/// A sphere as a binary STL file of more than a message of NATS may have.
std::string large_sphere() {
  constexpr int kRings = 120;
  const auto point = [](int i, int j) {
    const double a = std::numbers::pi * i / kRings;
    const double b = 2 * std::numbers::pi * (j % kRings) / kRings;
    const double r = i == 0 || i == kRings ? 0 : 8 * std::sin(a);
    return std::array{static_cast<float>(r * std::cos(b)), static_cast<float>(r * std::sin(b)),
                      static_cast<float>(8 * std::cos(a))};
  };
  std::string body;
  std::uint32_t count = 0;
  const auto facet = [&](const auto& a, const auto& b, const auto& c) {
    body.append(12, '\0');  // no normal
    for (const auto* corner : {&a, &b, &c}) {
      body.append(reinterpret_cast<const char*>(corner->data()), sizeof *corner);
    }
    body.append(2, '\0');
    ++count;
  };
  for (int i = 0; i < kRings; ++i) {
    for (int j = 0; j < kRings; ++j) {
      if (i + 1 < kRings) facet(point(i, j), point(i + 1, j), point(i + 1, j + 1));
      if (i > 0) facet(point(i, j), point(i + 1, j + 1), point(i, j + 1));
    }
  }
  std::string head(84, '\0');
  std::memcpy(head.data() + 80, &count, sizeof count);
  return head + body;
}

class Copies : public ClusterTest {
 protected:
  static void alone(net::ServerOptions& options) {
    options.cluster.node.clear();
    options.needs_copy = false;
  }
  /// Server a with a carved session that is copied.
  static void start_copied(Cluster& servers) {
    servers.start("a", alone);
    servers.create("a");
    servers.carve("a");
    servers.wait_for_copy("a");
  }
  static std::string fault(Cluster& servers, const std::string& name) {
    const Json info = servers.info(name);
    if (!info.is_object() || !info.at("copied").is_object()) return {};  // right after a start
    const Json text = info.at("copied").at("fault");
    return text.is_null() ? "" : text.get<std::string>();
  }
  static bool becomes_faulty(Cluster& servers, const std::string& name, const std::string& reason) {
    return servers.until([&] { return fault(servers, name).contains(reason); });
  }
};

TEST_F(Copies, WhatWasStatedAsCopiedIsInTheCopyAfterKillsAtAnyMoment) {
  EXPECT_EQ(faults_of([](Cluster& servers) {
              servers.start("a", alone);
              servers.create("a");
              servers.wait_for_copy("a");  // before it there is nothing to fetch
              servers.begin_carving("a", 4 * kSecond);
              for (int kill = 0; kill < 4; ++kill) {
                sleep_until(now() + static_cast<Time>(draw(700)) * kMillisecond);
                const Json info = servers.info("a");
                std::uint64_t stated = 0;  // right after a start nothing is
                if (info.is_object() && info.at("copied").is_object()) {
                  stated = info.at("copied").at("record");
                }
                servers.kill("a");
                const auto fetched = servers.fetch(servers.beside("a"));
                EXPECT_GE(fetched.position.record, stated);
                auto journal = batches(servers.file("a"));
                const auto copy = batches(servers.beside("a"));
                EXPECT_LE(copy.size(), journal.size());
                journal.resize(copy.size());
                EXPECT_EQ(copy, journal);
                servers.start("a");
              }
              servers.finish_carving();
              servers.wait_for_copy("a");
              EXPECT_TRUE(servers.is_copied_as_it_is("a"));
              servers.check_journal("a");
            }),
            "");
}

TEST_F(Copies, NatsThatIsAwayForAWhileGetsTheRestLater) {
  EXPECT_EQ(faults_of([](Cluster& servers) {
              NatsModel::instance().stop();
              servers.start("a", alone);
              servers.create("a");
              servers.carve("a");  // answered as ever
              EXPECT_TRUE(becomes_faulty(servers, "a", "cannot be reached"));
              NatsModel::instance().start();
              servers.wait_for_copy("a");
              EXPECT_TRUE(servers.is_copied_as_it_is("a"));
              const auto metrics = servers.ask("a", "GET", "/metrics").body;
              const std::string record = servers.info("a").at("copied").at("record").dump();
              const std::string label = "{session=\"block\"} ";
              EXPECT_TRUE(metrics.contains("\nkerf_copied_record" + label + record + "\n"));
              EXPECT_TRUE(metrics.contains("\nkerf_copied_snapshot_record" + label));
              EXPECT_TRUE(metrics.contains("\nkerf_copy_lag_records" + label + "0\n"));
              NatsModel::instance().stop();
              servers.carve("a");
              EXPECT_TRUE(becomes_faulty(servers, "a", "cannot be reached"));
              NatsModel::instance().start();
              servers.wait_for_copy("a");
              EXPECT_TRUE(servers.is_copied_as_it_is("a"));
            }),
            "");
}

TEST_F(Copies, MessagesThatNatsHasLostAreSentAgain) {
  EXPECT_EQ(faults_of([](Cluster& servers) {
              start_copied(servers);
              const NatsStore old = NatsModel::instance().store();
              servers.carve("a");
              servers.wait_for_copy("a");
              NatsModel::instance().stop();
              NatsModel::instance().set_store(old);
              NatsModel::instance().start();
              servers.carve("a");
              servers.wait_for_copy("a");
              EXPECT_TRUE(servers.is_copied_as_it_is("a"));
            }),
            "");
}

TEST_F(Copies, AFormerServerCannotChangeTheCopy) {
  EXPECT_EQ(faults_of([](Cluster& servers) {
              start_copied(servers);
              servers.at("a").stand_still(4 * kSecond);
              servers.start("b", alone);  // to have a disk
              servers.stop("b");
              servers.fetch(servers.file("b"));
              servers.start("b");
              servers.carve("b");
              servers.wait_for_copy("b");
              sleep_until(now() + 4 * kSecond);
              servers.carve("a");  // which does not know
              EXPECT_TRUE(becomes_faulty(servers, "a", "another server continues"));
              servers.carve("b");
              servers.wait_for_copy("b");
              EXPECT_TRUE(servers.is_copied_as_it_is("b"));
              for (const char* reason :
                   {"another server continues", "records that this journal does not have"}) {
                servers.stop("a");
                servers.start("a");  // of a greater epoch each time
                EXPECT_TRUE(becomes_faulty(servers, "a", reason)) << fault(servers, "a");
              }
              EXPECT_TRUE(servers.is_copied_as_it_is("b"));
            }),
            "");
}

TEST_F(Copies, AServerThatHasStoppedHasCopiedEverything) {
  EXPECT_EQ(faults_of([](Cluster& servers) {
              servers.start("a", alone);
              servers.create("a");
              servers.carve("a");
              servers.stop("a");
              EXPECT_TRUE(servers.is_copied_as_it_is("a"));
            }),
            "");
}

TEST_F(Copies, FilesThatAreLargerThanAMessageAreCopied) {
  EXPECT_EQ(faults_of(
                [](Cluster& servers) {
                  servers.start("a", alone);
                  const std::string mesh = large_sphere();
                  EXPECT_GT(mesh.size(), std::size_t{1} << 20);
                  const auto stored = servers.ask("a", "POST", "/v1/files?name=ball.stl", mesh);
                  EXPECT_EQ(stored.status, 201) << stored.body;
                  Json scene = Json::parse(kScene);
                  const Json file = Json::parse(stored.body).at("file");
                  scene["stock"] = {{"shape", "mesh"}, {"file", file}};
                  const auto made = servers.ask("a", "POST", "/v1/sessions?id=block", scene.dump());
                  EXPECT_EQ(made.status, 201) << made.body;
                  servers.wait_for_copy("a");
                  const Json expected = servers.block("a");
                  servers.start("b", alone);  // to have a disk
                  servers.stop("b");
                  servers.fetch(servers.file("b"));
                  servers.start("b");
                  EXPECT_TRUE(servers.until([&] { return servers.block("b") == expected; }));
                },
                1),
            "");
}

TEST_F(Copies, WithoutNatsNothingIsCopied) {
  EXPECT_EQ(
      faults_of(
          [](Cluster& servers) {
            servers.start("a", [](net::ServerOptions& options) {
              alone(options);
              options.copies.url.clear();
            });
            servers.create("a");
            EXPECT_TRUE(servers.info("a").at("copied").is_null());
            EXPECT_FALSE(servers.ask("a", "GET", "/metrics").body.contains("kerf_copied_record"));
            EXPECT_TRUE(NatsConnection::open("", "test")->streams()->empty());
          },
          1),
      "");
}

}  // namespace
}  // namespace kerf::sim::copies_test
