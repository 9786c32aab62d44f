// SPDX-License-Identifier: Apache-2.0
// The agent's replica of a block to which stock comes back, against the session.
#include "haptic_agent/replica/replica.h"
#include "kernel/dexel/dexel_field.h"
#include "tests/agent/replica/equal_near.h"
#include "tests/server/undo_fixture.h"
#include "tests/support/test.h"

namespace kerf::replica_undo_test {
namespace {

using agent::BlockSource;
using agent::Replica;

std::string scene(const std::string& rays) {
  return R"({"name": "undone", "stock": {"shape": "box", "min_mm": [-60, -20, -20], "max_mm": [60, 20, 0]},
    "accuracy": {"rays": ")" +
         rays + R"(", "pitch_mm": 0.5, "tolerance_mm": 0.01, "motion": "tight"},
    "tools": [{"id": 1, "shape": "ball", "diameter_mm": 6, "length_mm": 30}]})";
}

std::string welcome_of(const Scene& scene) {
  return R"({"stock":)" + stock_json(scene) + R"(,"tools":)" + tools_json(scene) + R"(,"force":)" +
         force_json(scene) + R"(,"accuracy":)" + accuracy_json(scene) + "}";
}

/// Ada has a replica. Samples and patches are in flight for a while. Bo has none.
class ReplicaUndo : public SessionUndo, public testing::WithParamInterface<const char*> {
 protected:
  struct Patch {
    StockUpdate update;
    std::uint64_t arrives_ms;
  };

  void begin(bool takes_returned = true) {
    limits_.samples_per_s = limits_.samples_burst = 1e9;  // faster than the real clock
    restart();
    create(scene(GetParam()));
    request_.stock = request_.intent = request_.durable = true;
    request_.returned = takes_returned;
    connect();
    bo_ = join("Bo");
  }
  /// Ada connects, or reconnects.
  void connect() {
    const Admission admission = session_->admit(request_).value();
    ada_ = admission.participant.id;
    request_.token = admission.token;
    replica_.emplace(BlockSource::read(welcome_of(*session_->scene())).value());
  }
  /// Moves Ada's tool: in the replica now, in the session `delay_ms_` later.
  std::optional<wire::Result> ada(Vec3 tip, bool cuts = true) {
    wire::MotionSample sample{.agent_sequence = ++sequences_[ada_],
                              .time_us = 1000 * ++now_ms_,
                              .tip_mm = tip,
                              .tool_id = 1,
                              .buttons = cuts ? wire::kButtonCutting : 0};
    const auto answer = replica_->move(sample);
    samples_.push_back(sample);
    while (samples_.size() > delay_ms_) arrive();
    return answer;
  }
  void arrive() {
    for (const Rejection& rejection : session_->move(ada_, {&samples_.front(), 1}).rejections) {
      EXPECT_EQ(rejection.code, wire::ErrorCode::kInStock);
      ++rejections_;
    }
    samples_.pop_front();
    send_patch();
    take_patches(now_ms_);
    if (looks_ahead_) replica_->take(session_->intents(ada_));
  }
  bool send_patch() {
    auto update = session_->replicas().update(ada_);
    if (!update) return false;
    resets_ += update->reset ? 1 : 0;
    returned_ += update->returned ? 1 : 0;
    patches_.push_back({*std::move(update), now_ms_ + delay_ms_});
    return true;
  }
  void take_patches(std::uint64_t until_ms) {
    while (!patches_.empty() && patches_.front().arrives_ms <= until_ms) {
      EXPECT_TRUE(replica_->take(patches_.front().update.patch()));
      EXPECT_TRUE(session_->replicas().ack(ada_, patches_.front().update.sequence));
      patches_.pop_front();
    }
  }
  void arrive_all() {
    while (!samples_.empty()) arrive();
    do {
      take_patches(UINT64_MAX);
    } while (send_patch());
  }
  /// Moves Ada's tool above a point, and compares the columns near it.
  void expect_equal_at(Vec3 tip) {
    for (int n = 0; n < 3; ++n) ada(tip, false);
    arrive_all();
    test::expect_equal_near(*replica_, session_->solid(), tip, 5);
  }
  void expect_equal() {
    for (int n = -5; n <= 5; ++n) expect_equal_at({11.0 * n, 0, 4});
  }
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 4294967296.0);
  }

  std::mt19937 random_{7};
  JoinRequest request_{ParticipantKind::kAgent, "Ada", "", 1, true};
  ParticipantId ada_ = 0, bo_ = 0;
  std::optional<Replica> replica_;
  std::deque<wire::MotionSample> samples_;
  std::deque<Patch> patches_;
  std::uint64_t now_ms_ = 0, delay_ms_ = 0;
  bool looks_ahead_ = false;
  int resets_ = 0, returned_ = 0, rejections_ = 0;
};

TEST_P(ReplicaUndo, EqualsTheServerToTheBitAfterCutsAndUndoAtAnyDelay) {
  begin();
  std::vector<StrokeId> done, undone;
  for (int round = 0; round < 16; ++round) {
    delay_ms_ = random_() % 40;
    looks_ahead_ = random_() % 2 == 0;
    const Vec3 start{uniform(-50, 50), uniform(-15, 15), uniform(-5, -1)};
    const Vec3 beside = start + Vec3{uniform(-6, 6), uniform(-6, 6), uniform(-2, 1)};
    done.push_back(stroke(bo_, beside, beside + Vec3{uniform(-8, 8), uniform(-8, 8), 0}, 30));
    double turn = 0;
    const auto tip = [&] { return start + Vec3{5 * std::sin(turn), 5 * std::cos(turn), 0}; };
    for (int n = 0; n < 8; ++n) ada(tip() + Vec3{0, 0, 8.0 - n}, false);
    const auto cut = [&] {  // in every third round no hand cuts
      turn += 0.1;
      if (turn < 8) ada(tip(), round % 3 != 0);
    };
    for (int n = 0; n < 10; ++n) cut();
    // Undo and redo while samples and tiles are in flight, of strokes of Bo and of Ada's newest.
    for (auto changes = 1 + random_() % 3; changes > 0; --changes) {
      if (random_() % 3 == 0) {
        const bool undoes = random_() % 3 != 0;
        (void)change({.undone = undoes, .participant = ada_, .author = ada_, .caller = {}}, cut);
        continue;
      }
      auto& from = undone.empty() || (!done.empty() && random_() % 3 != 0) ? done : undone;
      const auto at = from.begin() + static_cast<std::ptrdiff_t>(random_() % from.size());
      const StrokeId id = *at;
      from.erase(at);
      (&from == &done ? undone : done).push_back(id);
      const auto changed = change({.undone = &from == &done, .strokes = {id}}, cut);
      ASSERT_TRUE(changed) << changed.error().reason;
    }
    for (int n = 0; n < 10; ++n) ada(tip() + Vec3{0, 0, 1.0 * n}, false);
    if (round % 8 == 5) {
      arrive_all();
      connect();
    }
    if (round % 4 == 3) expect_equal();
    ASSERT_FALSE(HasFailure()) << "round " << round;
  }
  EXPECT_GT(returned_, 5);
}

TEST_P(ReplicaUndo, DistantUndoSendsOnlyItsTilesAndTheReplicaKeepsAnswering) {
  begin();
  const StrokeId far = stroke(bo_, {-50, -15, -3}, {-40, -15, -3});
  for (int n = 0; n < 40; ++n) ada({30 + 0.1 * n, 15, -2});
  arrive_all();
  ASSERT_EQ(resets_, 1) << "the first patch";
  undo({far});
  for (int n = 0; n < 40; ++n) EXPECT_TRUE(ada({34 + 0.1 * n, 15, -2})) << n;
  arrive_all();
  EXPECT_EQ(returned_, 1);
  expect_equal();
  redo({far});
  expect_equal();
  EXPECT_EQ(returned_, 2);
  EXPECT_EQ(resets_, 1);
}

TEST_P(ReplicaUndo, NearbyUndoPausesAnswersForTwoPitches) {
  begin();
  const StrokeId near = stroke(bo_, {26, 8, -3}, {40, 8, -3});
  for (int n = 0; n < 40; ++n) ada({30 + 0.1 * n, 0, -2});
  arrive_all();
  undo({near});
  ada({34, 0, -2});  // the tiles follow the tool
  double silent_mm = 0;
  for (int n = 1; n < 40; ++n) silent_mm += ada({34 + 0.1 * n, 0, -2}) ? 0 : 0.1;
  EXPECT_NEAR(silent_mm, 1, 0.15);
  expect_equal();
}

TEST_P(ReplicaUndo, AgentWithoutSupportForReturnedTilesIsReset) {
  begin(false);
  const StrokeId far = stroke(bo_, {-50, -15, -3}, {-40, -15, -3});
  for (int n = 0; n < 40; ++n) ada({30 + 0.1 * n, 15, -2});
  arrive_all();
  undo({far});
  expect_equal();
  EXPECT_EQ(returned_, 0);
  EXPECT_EQ(resets_, 2);
}

TEST_P(ReplicaUndo, RejectedCutsInReturnedStockAreReverted) {
  begin();
  const StrokeId groove = stroke(bo_, {28, 0, -4}, {36, 0, -4});
  for (int n = 0; n < 20; ++n) ada({30, 0, 6 - 0.5 * n}, false);
  arrive_all();
  ASSERT_EQ(resets_, 1) << "the first patch";
  delay_ms_ = 20;
  for (int n = 0; n < 10; ++n) ada({30 + 0.1 * n, 0, -3.5});
  undo({groove});
  for (int n = 0; n < 60; ++n) ada({31 + 0.05 * n, 0, -3.5});
  EXPECT_EQ(rejections_, 50);
  EXPECT_GT(resets_, 20) << "one for each, as far as frames may be in flight";
  for (int n = 0; n < 40; ++n) ada({34, 0, -3.5 + 0.2 * n}, false);
  expect_equal();
}

TEST_P(ReplicaUndo, DistantReturnedTilesAreUnknownUntilTheToolArrives) {
  begin();
  const StrokeId groove = stroke(bo_, {26, 0, -3}, {40, 0, -3});
  const auto go_to = [&](double x) {
    for (int n = 0; n < 3; ++n) ada({x, 0, -1}, false);
    arrive_all();
  };
  go_to(30);
  go_to(-40);
  EXPECT_TRUE(ada({30, 0, -1}, false)) << "it knows the place";
  go_to(-40);
  undo({groove});
  go_to(-40);
  EXPECT_FALSE(ada({30, 0, -1}, false));
  go_to(30);
  EXPECT_TRUE(ada({30, 0, -1}, false));
  expect_equal();
}

TEST_P(ReplicaUndo, OwnMotionsInFlightSurviveAnUndo) {
  begin();
  const StrokeId first = stroke(bo_, {20, 0, -4}, {36, 0, -4});
  for (int n = 0; n < 30; ++n) ada({30, -12 + 0.1 * n, -2});
  arrive_all();
  delay_ms_ = 60;
  for (int n = 0; n < 60; ++n) ada({30, -9 + 0.1 * n, -2});
  undo({first});
  for (int n = 0; n < 60; ++n) ada({30, -3 + 0.1 * n, -2});
  arrive_all();
  EXPECT_EQ(returned_, 1);
  EXPECT_EQ(resets_, 1);
  expect_equal();
}

TEST_P(ReplicaUndo, UndoCoversItsCutsInUnknownTiles) {
  begin();
  delay_ms_ = 1000;  // no data arrives
  for (int n = 0; n < 20; ++n) ada({-30 + 0.1 * n, 0, -3});
  while (!samples_.empty()) arrive();
  patches_.clear();
  const StrokeId own = session_->sequence() - 18;
  delay_ms_ = 0;
  for (int n = 0; n < 40; ++n) ada({-28, 0, -3 + 0.5 * n}, false);
  for (int n = 0; n < 40; ++n) ada({-28 + 1.5 * n, 0, 17}, false);
  undo({own});
  expect_equal();
  EXPECT_GT(returned_, 0);
}

INSTANTIATE_TEST_SUITE_P(Rays, ReplicaUndo, testing::Values("dexel", "tri-dexel"));

}  // namespace
}  // namespace kerf::replica_undo_test
