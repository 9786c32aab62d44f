// SPDX-License-Identifier: Apache-2.0
// Agents, programs and viewers of one session at the same time.
#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <future>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "tests/server/whole/hand.h"
#include "tests/server/whole/watcher.h"
#include "tests/server/whole/whole_server.h"
#include "tests/support/content_of.h"

namespace kerf::test::carving_test {
namespace {

constexpr const char* kFrame =
    "%\nG21 G90 G17 G94\nT2 M6\nG0 X-15 Y-15 Z5\nG1 Z-3 F600\nX15 F1200\nY15\nG3 X-15 Y15 I-15 "
    "J0\nG1 Z5\nM2\n%\n";

using Carving = WholeServer;

// A thread inherits niceness, and requests run on nice threads; a session must not.
TEST_F(Carving, TheThreadOfASessionIsNotNice) {
  std::map<std::string, int> niceness;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::string name = test::content_of(task.path() / "comm");
    name.pop_back();
    const int number = std::stoi(task.path().filename());
    niceness.emplace(name, getpriority(PRIO_PROCESS, static_cast<id_t>(number)));
  }
  const int own = getpriority(PRIO_PROCESS, 0);
  ASSERT_TRUE(niceness.contains("s:block"));
  ASSERT_TRUE(niceness.contains("workers"));
  EXPECT_EQ(niceness["s:block"], own);
  EXPECT_EQ(niceness["workers"], std::max(own, 5));
}

TEST_F(Carving, TwoAgentsAndAProgramRemoveTheStatedVolume) {
  Watcher eve(port);
  std::vector<std::future<double>> hands;
  for (const int n : {0, 1}) {
    hands.push_back(std::async(std::launch::async, [this, n] {
      Hand hand(port, "block", n == 0 ? "Ada" : "Bob");
      return hand.carve(300, n * std::numbers::pi);
    }));
  }
  const Json program = upload(kFrame, "pace=fast&name=frame.ngc");
  double total = 0;
  for (auto& hand : hands) {
    const double removed = hand.get();
    EXPECT_GT(removed, 1);
    total += removed;
  }
  const Json status = wait_for(program, "finished");
  EXPECT_EQ(status.at("progress"), 1.0);
  total += status.at("removed_volume_mm3").get<double>();
  const Json now = info();
  EXPECT_NEAR(now.at("removed_volume_mm3"), total, total * 1e-4);
  EXPECT_EQ(eve.settled(now.at("state_hash")).at("motions"), now.at("motions"));
}

TEST_F(Carving, AgentIsAnsweredWhileAProgramRuns) {
  std::string text = "G21 G90 T2 M6\nG0 X0 Y0 Z-1\n";
  for (int n = 0; n < 20'000; ++n) {
    text += "G1 X" + std::to_string(n % 2 == 0 ? -15 : 15) + " Y" + std::to_string(n % 30 - 15) +
            " F3000\n";
  }
  const Json program = upload(text + "M2\n", "pace=feed&name=long.ngc");
  Hand ada(port);
  ada.carve(50);
  EXPECT_EQ(made("GET", program.at("url")).at("state"), "running");
  EXPECT_EQ(made("DELETE", program.at("url")).at("state"), "cancelled");
  EXPECT_EQ(error("DELETE", program.at("url")), "409 not_running");
  const Json people = info().at("participants");
  ASSERT_EQ(people.size(), 1U);
  EXPECT_EQ(people.at(0).at("kind"), "agent");
}

// A motion of a flat tool as wide as the block takes many turns of the session.
TEST_F(Carving, AgentIsAnsweredDuringALargeMotionOfAnother) {
  Json accuracy = kBlock.at("accuracy");
  accuracy["pitch_mm"] = 0.1;
  create(
      "wide",
      scene_with({{"stock", {{"shape", "box"}, {"min_mm", {0, 0, -10}}, {"max_mm", {200, 200, 0}}}},
                  {"accuracy", accuracy},
                  {"tools",
                   {{{"id", 1}, {"shape", "flat"}, {"diameter_mm", 1000}, {"length_mm", 60}},
                    {{"id", 2}, {"shape", "ball"}, {"diameter_mm", 2}, {"length_mm", 60}}}}}));
  Hand mill(port, "wide", "Mill"), ball(port, "wide", "Ball", {{"tool", 2}});
  ball.move({{0, 0, 5}}, {.tool = 2});
  ball.result();
  while (mill.receive("participants").at("participants").size() < 2) continue;
  // The mill receives only its result after that.
  mill.move({{100, 100, 1}, {100, 100, -3}}, {.step_us = 100'000});
  int answered = 0;
  while (!mill.peer().has_input()) {
    ball.move({{1 + 0.1 * answered, 1, -4}}, {.tool = 2});
    ball.result();
    ++answered;
  }
  EXPECT_GT(mill.result().removed_mm3, 100'000);
  EXPECT_GT(answered, 3);
}

TEST_F(Carving, ParticipantsAreReportedWhenTheyJoinChangeTheirToolAndLeave) {
  std::optional<Hand> ada(std::in_place, port, "block", "Ada", Json{{"color", "#123456"}});
  Watcher eve(port);
  const Json& first = eve.welcome.at("participants");
  ASSERT_EQ(first.size(), 2U);
  for (const Json& one : first) {
    EXPECT_EQ(one.at("color") == "#123456", one.at("name") == "Ada");
  }
  const auto tool_of_ada = [&] {
    const Json list = eve.receive("participants").at("participants");
    for (const Json& one : list) {
      if (one.at("name") == "Ada") return one.at("tool").get<int>();
    }
    return 0;
  };
  ada->send({{"type", "tool"}, {"tool", 2}});
  while (tool_of_ada() != 2) continue;
  ada->move({{1, 2, 3}}, {.tool = 2});
  while (eve.tools.empty()) eve.take();
  EXPECT_EQ(eve.tools[0].participant, ada->participant);
  EXPECT_EQ(eve.tools[0].tool_id, 2U);
  EXPECT_EQ(eve.tools[0].tip_mm.z, 3);
  ada.reset();
  Json people = eve.receive("participants").at("participants");
  while (people.size() > 1) people = eve.receive("participants").at("participants");
  EXPECT_EQ(people.at(0).at("name"), "Grace");
}

TEST_F(Carving, IsCountedByTheMetrics) {
  EXPECT_EQ(made("GET", "/healthz"), Json({{"status", "ok"}}));
  Hand ada(port);
  ada.carve(20);
  Answer metrics;
  // An answer is counted once it has been sent.
  EXPECT_TRUE(eventually([&] {
    metrics = ask("GET", "/metrics");
    return metrics.body.contains("\nkerf_turnaround_seconds_count 20\n");
  })) << metrics.body;
  EXPECT_TRUE(metrics.header("Content-Type").starts_with("text/plain"));
  for (const char* line : {"\nkerf_sessions 1\n", "\nkerf_connections{kind=\"agent\"} 1\n",
                           "\nkerf_session_motions{session=\"block\"} 19\n"}) {
    EXPECT_TRUE(metrics.body.contains(line)) << line;
  }
}

TEST_F(Carving, ASessionIsDescribedClosedAndDeleted) {
  const Answer second = ask("POST", "/v1/sessions", kBlock.dump());
  EXPECT_EQ(second.status, 201U);
  EXPECT_EQ(second.json().at("id"), "block-2") << "the id of its name is taken";
  EXPECT_EQ(second.header("Location"), "/v1/sessions/block-2");
  {
    const Watcher eve(port);
    const Json now = info();
    EXPECT_EQ(now.at("stock_volume_mm3"), 40 * 40 * 20);
    EXPECT_EQ(now.at("stock").at("shape"), "box");
    EXPECT_EQ(now.at("tools").at(1).at("id"), 2);
    EXPECT_EQ(now.at("participants").at(0).at("kind"), "viewer");
  }
  Hand ada(port, "block-2");
  made("DELETE", "/v1/sessions/block-2");
  EXPECT_TRUE(ada.receive("bye").at("reason").get<std::string>().contains("closed"));
  EXPECT_EQ(error("GET", "/v1/sessions/block-2"), "404 unknown_session");
  int kept = 0;
  for (const auto& entry : std::filesystem::directory_iterator(data() / "closed")) {
    const std::string name = entry.path().filename();
    kept += name.starts_with("block-2-") && name.ends_with(".kerf") ? 1 : 0;
  }
  EXPECT_EQ(kept, 1);
  made("DELETE", "/v1/sessions/block?purge=1");
  for (const auto& entry : std::filesystem::directory_iterator(data())) {
    EXPECT_FALSE(entry.path().filename().string().starts_with("block")) << entry.path();
  }
  EXPECT_TRUE(made("GET", "/v1/sessions").at("sessions").empty());
}

}  // namespace
}  // namespace kerf::test::carving_test
