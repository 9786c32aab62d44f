// SPDX-License-Identifier: Apache-2.0
// The agent's replica of the block against the real session, which is authoritative.

#include "haptic_agent/replica/replica.h"

#include "kernel/dexel/dexel_field.h"
#include "tests/agent/replica/equal_near.h"
#include "tests/server/session_fixture.h"
#include "tests/support/test.h"

namespace kerf::replica_test {
namespace {

using agent::Agreement;
using agent::BlockSource;
using agent::Replica;

constexpr const char* kSpecificEnergy =
    R"({"law": "specific_energy", "specific_force_n_per_mm2": 0.4, "pivot_mm": 40})";
constexpr const char* kMilling =
    R"({"law": "mechanistic", "material": "beech", "runout_mm": 0.01, "pivot_mm": 40})";

std::string scene(const std::string& rays, const std::string& force) {
  return R"({"name": "copied", "stock": {"shape": "box", "min_mm": [-30, -30, -20], "max_mm": [30, 30, 0]},
    "accuracy": {"rays": ")" +
         rays + R"(", "pitch_mm": 0.5, "tolerance_mm": 0.01, "motion": "tight"},
    "tools": [{"id": 1, "shape": "ball", "diameter_mm": 6, "length_mm": 30},
              {"id": 2, "shape": "flat", "diameter_mm": 8, "length_mm": 20,
               "shank": {"diameter_mm": 12, "length_mm": 30}}],
    "force": )" +
         force + "}";
}

std::string welcome_of(const Scene& scene) {
  return R"({"stock":)" + stock_json(scene) + R"(,"tools":)" + tools_json(scene) + R"(,"force":)" +
         force_json(scene) + R"(,"accuracy":)" + accuracy_json(scene) + "}";
}

/// One agent with a replica, and another agent. `delay`: number of samples in flight from the agent
/// to the server.
class ReplicaTest : public SessionTest, public testing::WithParamInterface<const char*> {
 protected:
  void begin(const char* rays, const char* force = kSpecificEnergy) {
    // Samples arrive faster here than the session's rate limit permits.
    limits.samples_burst = max_samples;
    limits.samples_per_s = max_samples / 10;  // hardly one during a burst, even on a busy machine
    restart();
    in_flight_.clear();
    sequence = other_sequence_ = 0;
    auto created = test::value_of(
        registry->create("block" + std::to_string(++blocks_), scene(rays, force), SceneSource{}));
    session_ = created;
    self_ =
        session_
            ->join({.kind = ParticipantKind::kAgent, .name = "hand", .color = "", .stock = true})
            .value()
            .id;
    other_ = join(*session_, "other");
    auto source = test::value_of(BlockSource::read(welcome_of(*session_->scene())));
    replica_.emplace(std::move(source));
  }

  /// Sends the agent's next sample: to the replica at once, to the server `delay` samples later.
  std::optional<wire::Result> send(Vec3 tip, Vec3 axis = {0, 0, 1}, std::uint32_t tool = 1,
                                   std::uint32_t buttons = wire::kButtonCutting) {
    wire::MotionSample sample = next(tip.x, tip.y, tip.z);
    sample.axis = {static_cast<float>(axis.x), static_cast<float>(axis.y),
                   static_cast<float>(axis.z)};
    sample.tool_id = tool;
    sample.buttons = buttons;
    in_flight_.push_back(sample);
    const auto local = replica_->move(sample);
    while (in_flight_.size() > delay) arrive();
    return local;
  }
  void arrive() {
    remote_ = session_->move(self_, {&in_flight_.front(), 1}).result;
    in_flight_.pop_front();
    replica_->compare(remote_.agent_time_us, Vec3(remote_.force_n));
    deliver_update();
  }
  void arrive_all() {
    while (!in_flight_.empty()) arrive();
    while (deliver_update()) {
    }
  }
  /// Delivers a patch to the replica and its acknowledgement to the session.
  bool deliver_update() {
    const auto update = session_->replicas().update(self_);
    if (!update) return false;
    EXPECT_TRUE(session_->replicas().ack(self_, update->sequence));
    EXPECT_TRUE(replica_->take(update->patch()));
    return true;
  }
  void other(Vec3 tip) {
    wire::MotionSample sample{.agent_sequence = ++other_sequence_,
                              .time_us = 1000 * other_sequence_,
                              .tip_mm = {tip.x, tip.y, tip.z},
                              .tool_id = 1,
                              .buttons = wire::kButtonCutting};
    EXPECT_TRUE(session_->move(other_, {&sample, 1}).rejections.empty());
  }
  void expect_equal_near(Vec3 tip) {
    test::expect_equal_near(*replica_, session_->solid(), tip, 3);
  }

  std::shared_ptr<Session> session_;
  ParticipantId self_ = 0, other_ = 0;
  std::optional<Replica> replica_;
  std::deque<wire::MotionSample> in_flight_;
  std::size_t delay = 0;
  double max_samples = 1e12;
  std::uint64_t other_sequence_ = 0;
  wire::Result remote_;
  int blocks_ = 0;
};

Vec3 winding(int n) {
  const double a = 0.02 * n;
  return {12 * std::cos(a), 12 * std::sin(1.7 * a), -3 - 2 * std::sin(0.31 * a)};
}

TEST_P(ReplicaTest, AnswersEqualTheServers) {
  begin(GetParam());
  int answered = 0, pushed = 0;
  for (int n = 0; n < 600; ++n) {
    const Vec3 lean{0.3 * std::sin(0.01 * n), 0.2, 1};
    const auto local = send(winding(n), lean * (1 / length(lean)));
    if (!local) continue;
    ++answered;
    pushed += local->force_n != Vec3f{};
    EXPECT_EQ(local->force_n, remote_.force_n) << n;
    EXPECT_EQ(local->torque_nmm, remote_.torque_nmm) << n;
    EXPECT_EQ(local->engaged_area_mm2, remote_.engaged_area_mm2) << n;
    EXPECT_EQ(local->cut_centre_mm, remote_.cut_centre_mm) << n;
  }
  EXPECT_GT(answered, 590);
  EXPECT_GT(pushed, 500);
  arrive_all();
  EXPECT_EQ(replica_->agreement().error(), 0);
  expect_equal_near(winding(599));
}

TEST_P(ReplicaTest, FeelsTheMillingForceOfTheServer) {
  begin(GetParam(), kMilling);
  int pushed = 0;
  for (int n = 0; n < 200; ++n) {
    const auto local = send(winding(n));
    if (!local) continue;
    pushed += local->force_n != Vec3f{};
    EXPECT_EQ(local->force_n, remote_.force_n) << n;
    EXPECT_EQ(local->torque_nmm, remote_.torque_nmm) << n;
  }
  EXPECT_GT(pushed, 150);
}

TEST_P(ReplicaTest, RemovesTheImprintOfAToolLikeTheServer) {
  // The ball begins to cut 4 mm inside the block. The wider mill replaces it in the slot.
  begin(GetParam());
  const Vec3 start{0, 0, -4};
  send(start, {0, 0, 1}, 1, 0);
  int imprints = 0;
  Vec3 tip = start;
  for (int i = 0; i < 60; ++i) {
    tip.x += 0.05;
    const std::uint32_t tool = i < 30 ? 1 : 2;
    const auto local = send(tip, {0, 0, 1}, tool);
    if (!local) continue;
    EXPECT_EQ(local->status, remote_.status) << i;
    EXPECT_FLOAT_EQ(local->removed_mm3, remote_.removed_mm3) << i;
    EXPECT_NEAR(local->force_n.x, remote_.force_n.x, 1e-4) << i;
    // Half of the section of a ball or mill at a depth of 4 mm, with the ripple of one field.
    EXPECT_LT(length(Vec3(local->force_n)), 1.3 * 0.4 * 8 * 4) << i;
    imprints += (remote_.status & wire::kStatusImprint) != 0 ? 1 : 0;
  }
  EXPECT_EQ(imprints, 2);
}

TEST_P(ReplicaTest, AnswersDoNotDependOnTheDelay) {
  begin(GetParam());
  std::vector<Vec3f> near;
  for (int n = 0; n < 400; ++n) {
    const auto local = send(winding(n));
    near.push_back(local ? local->force_n : Vec3f{});
  }
  delay = 120;
  begin(GetParam());
  int answered = 0, in_a_row = 0;
  for (int n = 0; n < 400; ++n) {
    const auto local = send(winding(n));
    in_a_row = local ? in_a_row + 1 : 0;
    if (!local) continue;
    // Stock that was cut before it was known has little influence. Later only the points at which
    // the travel is divided differ (TravelQueue). The force is 8 N.
    ++answered;
    const Vec3 error = Vec3(local->force_n) - Vec3(near[static_cast<std::size_t>(n)]);
    for (const double component : {error.x, error.y, error.z}) {
      EXPECT_NEAR(component, 0, in_a_row <= 30 ? 0.4 : 0.1) << n;
    }
  }
  EXPECT_GT(answered, 200) << "nearby tiles must be known soon after the first patch";
  arrive_all();
  EXPECT_LT(replica_->agreement().error(), 0.05);
}

TEST_P(ReplicaTest, AppliesTheCutsOfOtherAgents) {
  begin(GetParam());
  delay = 30;
  for (int n = 0; n < 500; ++n) {
    send(winding(n));
    other({10 - 0.04 * n, 12 * std::sin(0.03 * n), -5});
  }
  arrive_all();
  expect_equal_near(winding(499));
}

TEST_P(ReplicaTest, StartsWithAPreviouslyCarvedBlock) {
  begin(GetParam());
  for (int n = 0; n < 300; ++n) other(winding(n) - Vec3{0, 0, 3});
  for (int n = 0; n < 300; ++n) {
    const auto local = send(winding(n));
    if (local) {
      EXPECT_EQ(local->force_n, remote_.force_n) << n;
    }
  }
  arrive_all();
  expect_equal_near(winding(299));
}

TEST_P(ReplicaTest, KeepsItsOwnCutsAfterAReset) {
  begin(GetParam());
  delay = 50;
  for (int n = 0; n < 200; ++n) send(winding(n));
  other(winding(400));
  other(winding(405));
  session_->replicas().reset(self_);
  for (int n = 200; n < 300; ++n) send(winding(n));
  arrive_all();
  EXPECT_LT(replica_->agreement().error(), 0.05);
  expect_equal_near(winding(299));
}

TEST_P(ReplicaTest, MotionRejectedByBothChangesNeitherBlock) {
  begin(GetParam());
  send({-20, 0, -4});
  send({20, 0, -4});  // 40 m/s
  for (int n = 0; n < 50; ++n) send({20 - 0.1 * n, 0, -4});
  arrive_all();
  expect_equal_near({15, 0, -4});
}

TEST_P(ReplicaTest, MotionRejectedByTheServerOnlyIsRepaired) {
  max_samples = 20;
  begin(GetParam());
  for (int n = 0; n < 40; ++n) send({-10 + 0.5 * n, 0, -4});  // the last ones exceed the rate limit
  EXPECT_TRUE(remote_.status & wire::kStatusRejected);
  while ((remote_.status & wire::kStatusRejected) != 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    send({9.5, 0, -4});
  }
  arrive_all();
  expect_equal_near({9.5, 0, -4});
}

TEST_P(ReplicaTest, TilesKnownBeforeAResetAreSentAgain) {
  begin(GetParam());
  for (int n = 0; n < 20; ++n) send({-20, -20, -1}, {0, 0, 1}, 1, 0);
  ASSERT_TRUE(send({-20, -20, -1}, {0, 0, 1}, 1, 0));
  for (int n = 0; n < 20; ++n) send({24, 24, -1}, {0, 0, 1}, 1, 0);
  session_->replicas().reset(self_);
  send({24, 24, -1}, {0, 0, 1}, 1, 0);
  EXPECT_TRUE(send({24, 24, -1}, {0, 0, 1}, 1, 0));
  delay = 5;
  EXPECT_FALSE(send({-20, -20, -1}, {0, 0, 1}, 1, 0));
  arrive_all();
  EXPECT_TRUE(send({-20, -20, -1}, {0, 0, 1}, 1, 0));
}

TEST_P(ReplicaTest, RendersContactOfANonCuttingTool) {
  begin(GetParam());
  for (int n = 0; n < 40; ++n) send({0, 0, 6 - 0.1 * n}, {0, 0, 1}, 1, 0);
  int touched = 0;
  for (int n = 0; n < 40; ++n) {
    const auto local = test::value_of(send({0, 0, 1 - 0.1 * n}, {0, 0, 1}, 1, 0));
    EXPECT_EQ(local.plane_count, remote_.plane_count);
    EXPECT_EQ(local.force_n, remote_.force_n);
    touched += local.force_n.z > 0;
  }
  EXPECT_GT(touched, 20);
}

TEST_P(ReplicaTest, RendersContactOfTheShank) {
  begin(GetParam());
  for (int n = 0; n < 400; ++n) {
    const auto local = send({-34 + 0.1 * n, 0, -19}, {0, 0, 1}, 2);
    if (!local) continue;
    EXPECT_EQ(local->plane_count, remote_.plane_count) << n;
    EXPECT_EQ(local->collision_force_n, remote_.collision_force_n) << n;
  }
}

TEST_P(ReplicaTest, AcknowledgementsOfUnsentPatchesAreRejected) {
  begin(GetParam());
  EXPECT_EQ(session_->replicas().ack(other_, 1).error().code, wire::ErrorCode::kBadMessage);
  EXPECT_EQ(session_->replicas().ack(self_, 1).error().code, wire::ErrorCode::kBadSequence);
  EXPECT_FALSE(session_->replicas().update(other_)) << "no updates without a replica";
  send({0, 0, 2});
  EXPECT_TRUE(session_->replicas().ack(self_, 1));
}

INSTANTIATE_TEST_SUITE_P(Rays, ReplicaTest, testing::Values("dexel", "tri-dexel"));

TEST_F(SessionTest, ReplicaDoesNotAnswerWhereTilesAreUnknown) {
  const auto session = start();
  auto source = test::value_of(BlockSource::read(welcome_of(*session->scene())));
  Replica replica(std::move(source));
  EXPECT_FALSE(replica.move(next(0, 0, -1)));
  EXPECT_FALSE(replica.move(next(0.1, 0, -1)));
  EXPECT_EQ(replica.tiles_known(), 0U);
  Replica beside(*BlockSource::read(welcome_of(*session->scene())));
  EXPECT_TRUE(beside.move(next(60, 0, -1))) << "no tiles are needed outside the block";
}

TEST_F(SessionTest, ReplicaRejectsInvalidTiles) {
  const auto session = start();
  Replica replica(*BlockSource::read(welcome_of(*session->scene())));
  const std::uint64_t before = SolidSnapshot(session->solid()).hash();
  const std::array<std::byte, 1> garbage{std::byte{3}};
  wire::StockPatch patch{.tiles = {{2, 1, 1, garbage}}};
  EXPECT_FALSE(replica.take(patch));
  for (const wire::StockTile& tile :
       {wire::StockTile{2, 99, 0, {}}, wire::StockTile{2, 0xFFFFFFFF, 0, {}},
        wire::StockTile{0, 0, 0, {}}}) {
    patch.tiles = {tile};
    EXPECT_FALSE(replica.take(patch));
  }
  EXPECT_EQ(replica.tiles_known(), 0U);
  EXPECT_EQ(replica.block().field(RayAxis::kZ)->find({1, 1}), nullptr);
  EXPECT_EQ(SolidSnapshot(session->solid()).hash(), before);
}

TEST_F(SessionTest, IncompleteWelcomeIsRejected) {
  const auto session = start();
  EXPECT_FALSE(BlockSource::read("{}"));
  EXPECT_FALSE(BlockSource::read("not json"));
  std::string text = welcome_of(*session->scene());
  text.replace(text.find("\"ball\""), 6, "\"spoon\"");
  const auto error = test::error_of(BlockSource::read(text));
  EXPECT_NE(error.find("spoon"), std::string::npos) << error;
}

}  // namespace
}  // namespace kerf::replica_test
