// SPDX-License-Identifier: Apache-2.0
// A session whose agents carve in parallel on several threads: state, journal and results equal
// those of one thread that takes the motions in journal order.
#include "tests/server/session_fixture.h"
#include "tests/support/shuffled_workers.h"
#include "tests/support/test.h"
#include "tests/support/thread_workers.h"

namespace kerf::session_cores_test {
namespace {

/// Tool 2 has a shank that touches the stock; tool 3 covers more than a turn's tiles.
constexpr const char* kCoresScene = R"({
  "name": "Cores",
  "stock": {"shape": "box", "min_mm": [-40, -40, -20], "max_mm": [40, 40, 0]},
  "accuracy": {"rays": "RAYS", "pitch_mm": 0.1, "tolerance_mm": 0.01, "motion": "tight"},
  "tools": [{"id": 1, "shape": "ball", "diameter_mm": 8, "length_mm": 60},
            {"id": 2, "shape": "ball", "diameter_mm": 6, "length_mm": 4,
             "shank": {"diameter_mm": 10, "length_mm": 30}},
            {"id": 3, "shape": "flat", "diameter_mm": 200, "length_mm": 60}],
  "obstacles": [{"shape": "sphere", "center_mm": [0, 0, 8], "radius_mm": 6,
                 "stiffness_n_per_mm": 1}],
  "machine": {"kinematics": "tool-vector"}})";

/// "free": one field, and no obstacle, at which resting tools would move in place.
std::string scene_with(const std::string& rays) {
  std::string scene = kCoresScene;
  scene.replace(scene.find("RAYS"), 4, rays == "free" ? "dexel" : rays);
  if (rays != "free") return scene;
  const std::size_t obstacles = scene.find("\"obstacles\"");
  return scene.erase(obstacles, scene.find("\"machine\"") - obstacles);
}

constexpr std::size_t kAgents = 5;

/// The samples of all agents, in rounds of one sample each. `rests`: share of samples without
/// travel.
std::vector<std::array<wire::MotionSample, kAgents>> random_rounds(int rounds, double apart_mm,
                                                                   double step_mm = 0.6,
                                                                   double rests = 0) {
  std::mt19937 random(7);
  const test::Uniform in(random);
  std::array<Vec3, kAgents> at;
  for (std::size_t a = 0; a < kAgents; ++a) at[a] = {(double(a) - 2) * apart_mm, in(-2, 2), -1};
  std::vector<std::array<wire::MotionSample, kAgents>> all(static_cast<std::size_t>(rounds));
  for (std::size_t r = 0; r < all.size(); ++r) {
    for (std::size_t a = 0; a < kAgents; ++a) {
      const Vec3 step = Vec3{in(-1, 1), in(-1, 1), in(-0.6, 0.5)} * step_mm;
      if (rests == 0 || in(0, 1) >= rests) at[a] = at[a] + step;
      wire::MotionSample& sample = all[r][a];
      sample.agent_sequence = r + 1;
      sample.time_us = 1000 * (r + 1);
      sample.tip_mm = at[a];
      sample.tool_id = 1 + std::uint32_t(a % 2);
      if (in(0, 1) < 0.9) sample.buttons = wire::kButtonCutting;
      if (in(0, 1) < 0.03) sample.tool_id = 99;  // rejected
    }
  }
  return all;
}

class SessionCores : public SessionTest {
 protected:
  void SetUp() override {
    registry.emplace(
        RegistryOptions{folder.path(), 16, limits}, [this](const std::string&) { return executor; },
        workers);
  }
  std::shared_ptr<Session> open(const std::string& id, const std::string& rays) {
    auto created = registry->create(id, scene_with(rays), SceneSource{});
    EXPECT_TRUE(created) << created.error().reason;
    for (std::size_t a = 0; a < kAgents; ++a) agents[a] = join(**created, "agent");
    return *created;
  }
  static wire::Result comparable(const MotionAnswer& answer) {
    wire::Result result = answer.result;
    result.motions_applied = result.durable_sequence = 0;
    return result;
  }
  std::uint64_t replayed_hash(Session& session) {
    EXPECT_TRUE(session.flush());
    const auto replayed = replay(session.journal_file());
    EXPECT_TRUE(replayed);
    return replayed->hash.hash;
  }

  std::array<ParticipantId, kAgents> agents{};
};

TEST_F(SessionCores, GiveTheBytesOfOneThread) {
  test::ThreadWorkers two(2), five(5);
  test::ShuffledWorkers shuffled;
  Workers* const all_workers[] = {&two, &five, &shuffled};
  int number = 0;
  for (const std::string rays : {"dexel", "tri-dexel"}) {
    for (const double apart_mm : {2.0, 15.0}) {
      SCOPED_TRACE(rays + ' ' + std::to_string(apart_mm));
      const auto rounds = random_rounds(30, apart_mm);
      const std::string name = "block" + std::to_string(++number);
      const auto alone = open(name + "-one", rays);
      std::vector<wire::Result> expected(rounds.size() * kAgents);
      std::vector<std::size_t> rejections(expected.size());
      std::size_t first = 0;
      for (const auto& round : rounds) {
        // Tools that do not cut are pushed by the stock as of the beginning of the round.
        for (const std::uint32_t buttons : {0U, wire::kButtonCutting}) {
          for (std::size_t a = 0; a < kAgents; ++a) {
            if (round[a].buttons != buttons) continue;
            const MotionAnswer answer = alone->move(agents[a], {&round[a], 1});
            expected[first + a] = comparable(answer);
            rejections[first + a] = answer.rejections.size();
          }
        }
        first += kAgents;
      }
      EXPECT_TRUE(std::ranges::any_of(expected, [](auto& r) { return r.plane_count > 0; }));
      EXPECT_TRUE(std::ranges::any_of(rejections, [](std::size_t n) { return n > 0; }));
      Workers& carvers = *all_workers[number % 3];
      const auto together = open(name + "-more", rays);
      together->carve_on(carvers);
      std::size_t waited = 0, next = 0;
      for (const auto& round : rounds) {
        std::array<std::optional<MotionAnswer>, kAgents> answers;
        for (std::size_t a = 0; a < kAgents; ++a) {
          answers[a] = together->begin_move(agents[a], {&round[a], 1});
          waited += answers[a] ? 0 : 1;
        }
        for (std::size_t n = 0; n < kAgents; ++n) {
          const std::size_t a = (n + round[0].agent_sequence) % kAgents;
          while (!answers[a]) answers[a] = together->go_on(agents[a]);
        }
        for (std::size_t a = 0; a < kAgents; ++a, ++next) {
          SCOPED_TRACE("sample " + std::to_string(next));
          EXPECT_EQ(comparable(*answers[a]), expected[next]);
          EXPECT_EQ(answers[a]->rejections.size(), rejections[next]);
        }
      }
      EXPECT_GT(waited, rounds.size() * (kAgents - 1));
      EXPECT_EQ(together->sequence(), alone->sequence());
      EXPECT_EQ(together->solid().hash(), alone->solid().hash());
      EXPECT_EQ(together->info().removed_mm3, alone->info().removed_mm3);
      EXPECT_EQ(together->solid().hash(), replayed_hash(*together));
      alone->close("done");
      together->close("done");
    }
  }
  EXPECT_GT(two.runs() + five.runs() + shuffled.runs(), 0);
}

// The tools are far apart, so that none touches another one's cut. Without the obstacle, resting
// tools keep the force of the previous motion, which may be of the same frame.
TEST_F(SessionCores, GiveTheResultsOfOneThread) {
  for (const std::string rays : {"dexel", "free"}) {
    SCOPED_TRACE(rays);
    constexpr std::size_t kFrames = 6, kSamples = 5;
    const auto rounds = random_rounds(kFrames * kSamples, 16, 0.2, rays == "free" ? 0.5 : 0);
    const auto frame_of = [&](std::size_t frame, std::size_t agent) {
      std::vector<wire::MotionSample> samples;
      for (std::size_t n = 0; n < kSamples; ++n) {
        samples.push_back(rounds[frame * kSamples + n][agent]);
      }
      return samples;
    };
    test::ShuffledWorkers carvers;
    const auto alone = open("one-" + rays, rays);
    const std::array<ParticipantId, kAgents> agents_alone = agents;
    const auto together = open("more-" + rays, rays);
    together->carve_on(carvers);
    for (std::size_t frame = 0; frame < kFrames; ++frame) {
      std::array<MotionAnswer, kAgents> expected;
      std::array<std::optional<MotionAnswer>, kAgents> answers;
      for (std::size_t a = 0; a < kAgents; ++a) {
        expected[a] = alone->move(agents_alone[a], frame_of(frame, a));
        answers[a] = together->begin_move(agents[a], frame_of(frame, a));
      }
      for (std::size_t a = 0; a < kAgents; ++a) {
        SCOPED_TRACE("frame " + std::to_string(frame) + " agent " + std::to_string(a));
        while (!answers[a]) answers[a] = together->go_on(agents[a]);
        EXPECT_EQ(comparable(*answers[a]), comparable(expected[a]));
        EXPECT_EQ(answers[a]->rejections.size(), expected[a].rejections.size());
      }
    }
    EXPECT_GT(carvers.runs(), 0);
    EXPECT_EQ(together->solid().hash(), alone->solid().hash());
    EXPECT_EQ(together->solid().hash(), replayed_hash(*together));
  }
}

class SessionOnTwoCores : public SessionCores {
 protected:
  void SetUp() override {
    SessionCores::SetUp();
    session = open("block", "dexel");
    session->carve_on(two);
    // An agent counts as moving once it has sent a sample.
    for (const ParticipantId agent : agents) {
      wire::MotionSample sample = next(0, 0, 30);
      sample.buttons = 0;
      session->move(agent, {&sample, 1});
    }
  }
  MotionAnswer finish(std::size_t agent) {
    std::optional<MotionAnswer> answer;
    while (!answer) answer = session->go_on(agents[agent]);
    return *std::move(answer);
  }

  test::ThreadWorkers two{2};
  std::shared_ptr<Session> session;
};

TEST_F(SessionOnTwoCores, CarveFramesOfSeveralSamples) {
  double removed_mm3 = 0;
  for (int frame = 0; frame < 4; ++frame) {
    for (std::size_t a = 0; a < kAgents; ++a) {
      std::vector<wire::MotionSample> samples;
      for (std::size_t n = 0; n <= a; ++n) {
        samples.push_back(next(14 * (double(a) - 2) + 0.2 * double(n), frame, -2));
      }
      ASSERT_FALSE(session->begin_move(agents[a], samples));
    }
    for (std::size_t a = 0; a < kAgents; ++a)
      removed_mm3 += double(finish(kAgents - 1 - a).result.removed_mm3);
  }
  EXPECT_NEAR(removed_mm3, session->info().removed_mm3, 1e-3);
  EXPECT_GT(removed_mm3, 100);
  EXPECT_EQ(session->solid().hash(), replayed_hash(*session));
}

TEST_F(SessionOnTwoCores, CutALongMotionInPiecesLast) {
  const std::array mill = {next(0, 0, 1), next(0, 0, -1)};
  std::array wide = mill;
  for (wire::MotionSample& sample : wide) sample.tool_id = 3;
  const std::array near = {next(20, 20, -2), next(20.5, 20, -2)};
  ASSERT_FALSE(session->begin_move(agents[0], near));
  ASSERT_FALSE(session->begin_move(agents[1], wide));
  EXPECT_GT(finish(0).result.removed_mm3, 0);
  EXPECT_TRUE(session->is_between_records());
  EXPECT_GT(finish(1).result.removed_mm3, 5000);
  EXPECT_FALSE(session->is_between_records());
  EXPECT_EQ(session->solid().hash(), replayed_hash(*session));
}

TEST_F(SessionOnTwoCores, AWideMotionTakesATurnsWorkOfOneThread) {
  test::ThreadWorkers eight(8);  // eight threads, in whose turn they could cut all of its 625 tiles
  session->carve_on(eight);
  std::array wide = {next(0, 0, 1), next(0, 0, -1)};
  for (wire::MotionSample& sample : wide) sample.tool_id = 3;
  ASSERT_FALSE(session->begin_move(agents[0], wide));
  int turns = 1;
  while (!session->go_on(agents[0])) ++turns;
  EXPECT_GE(turns, 625 / kTilesPerTurn);
}

TEST_F(SessionOnTwoCores, DropQueuedBatchesWhenTheirAgentLeaves) {
  const std::array first = {next(-20, 0, -2), next(-19, 0, -2)};
  const std::array second = {next(20, 0, -2), next(21, 0, -2)};
  ASSERT_FALSE(session->begin_move(agents[0], first));
  ASSERT_FALSE(session->begin_move(agents[1], second));
  const std::uint64_t before = session->sequence();
  session->leave(agents[0]);
  EXPECT_GT(finish(1).result.removed_mm3, 0);
  EXPECT_EQ(session->sequence(), before + 1);
  EXPECT_EQ(session->solid().hash(), replayed_hash(*session));
}

TEST_F(SessionOnTwoCores, RejectTheMotionsOfAMutedAgentOnly) {
  const std::array first = {next(-20, 0, -2), next(-19, 0, -2)};
  const std::array second = {next(20, 0, -2), next(21, 0, -2)};
  ASSERT_FALSE(session->begin_move(agents[0], first));
  ASSERT_FALSE(session->begin_move(agents[1], second));
  ASSERT_TRUE(session->people().set_muted(agents[0], true));
  const MotionAnswer muted = finish(0);
  ASSERT_FALSE(muted.rejections.empty());
  EXPECT_EQ(muted.rejections.back().code, wire::ErrorCode::kMuted);
  EXPECT_EQ(muted.result.removed_mm3, 0);
  EXPECT_GT(finish(1).result.removed_mm3, 0);
}

TEST_F(SessionOnTwoCores, AnswerALoneAgentAtOnce) {
  for (std::size_t a = 1; a < kAgents; ++a) session->leave(agents[a]);
  const std::array samples = {next(-20, 0, -2), next(-19, 0, -2)};
  EXPECT_TRUE(session->begin_move(agents[0], samples));
}

}  // namespace
}  // namespace kerf::session_cores_test
