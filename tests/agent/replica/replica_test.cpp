// SPDX-License-Identifier: Apache-2.0
// The agent's copy of the block against the real session, which has the authority.

#include "haptic_agent/replica/replica.h"

#include <gtest/gtest.h>

#include <chrono>
#include <deque>
#include <thread>

#include "kernel/dexel/dexel_field.h"
#include "kernel/tool/tool_bounds.h"
#include "tests/server/session_fixture.h"

namespace kerf {
namespace {

using agent::Agreement;
using agent::BlockSource;
using agent::Replica;

std::string scene(const std::string& rays) {
  return R"({"name": "copied", "stock": {"shape": "box", "min_mm": [-30, -30, -20], "max_mm": [30, 30, 0]},
    "accuracy": {"rays": ")" +
         rays + R"(", "pitch_mm": 0.5, "tolerance_mm": 0.01, "motion": "tight"},
    "tools": [{"id": 1, "shape": "ball", "diameter_mm": 6, "length_mm": 30},
              {"id": 2, "shape": "flat", "diameter_mm": 8, "length_mm": 20,
               "shank": {"diameter_mm": 12, "length_mm": 30}}],
    "force": {"law": "specific_energy", "specific_force_n_per_mm2": 0.4, "pivot_mm": 40}})";
}

std::string welcome_of(const Scene& scene) {
  return R"({"stock":)" + stock_json(scene) + R"(,"tools":)" + tools_json(scene) + R"(,"force":)" +
         force_json(scene) + R"(,"accuracy":)" + accuracy_json(scene) + "}";
}

/// One agent with a copy, and whoever else is at the block. `delay` is how many samples of the
/// agent are on their way to the server.
class ReplicaRoom : public SessionTest, public testing::WithParamInterface<const char*> {
 protected:
  void begin(const char* rays) {
    // Samples come faster here than the clock by which the session limits rates.
    limits.samples_burst = samples_most;
    limits.samples_per_s = 2.5 * samples_most;
    restart();
    way_.clear();
    sequence = other_sequence_ = 0;
    auto created =
        registry->create("block" + std::to_string(++blocks_), scene(rays), SceneSource{});
    ASSERT_TRUE(created) << created.error().reason;
    session_ = *created;
    hand_ =
        session_
            ->join({.kind = ParticipantKind::kAgent, .name = "hand", .color = "", .stock = true})
            .value()
            .id;
    other_ = join(*session_, "other");
    auto source = BlockSource::read(welcome_of(session_->scene()));
    ASSERT_TRUE(source) << source.error();
    copy_.emplace(*std::move(source));
  }

  /// The hand's next sample: the copy has it at once, the server `delay` samples later.
  std::optional<wire::Result> hand(Vec3 tip, Vec3 axis = {0, 0, 1}, std::uint32_t tool = 1,
                                   std::uint32_t buttons = wire::kButtonCutting) {
    wire::MotionSample sample = next(tip.x, tip.y, tip.z);
    sample.axis = {static_cast<float>(axis.x), static_cast<float>(axis.y),
                   static_cast<float>(axis.z)};
    sample.tool_id = tool;
    sample.buttons = buttons;
    way_.push_back(sample);
    const auto mine = copy_->move(sample);
    while (way_.size() > delay) arrive();
    return mine;
  }
  void arrive() {
    theirs_ = session_->move(hand_, {&way_.front(), 1}).result;
    way_.pop_front();
    copy_->compare(theirs_);
    tell();
  }
  void arrive_all() {
    while (!way_.empty()) arrive();
    while (tell()) {
    }
  }
  /// A patch there and its acknowledgement back.
  bool tell() {
    const auto news = session_->stock_update(hand_);
    if (!news) return false;
    EXPECT_TRUE(session_->ack_stock(hand_, news->sequence));
    EXPECT_TRUE(copy_->take(news->patch()));
    return true;
  }
  void other(Vec3 tip) {
    wire::MotionSample sample;
    sample.agent_sequence = ++other_sequence_;
    sample.time_us = 1000 * other_sequence_;
    sample.tip_mm = {tip.x, tip.y, tip.z};
    sample.tool_id = 1;
    sample.buttons = wire::kButtonCutting;
    EXPECT_TRUE(session_->move(other_, {&sample, 1}).rejections.empty());
  }
  void expect_equal_near(Vec3 tip) {
    const SolidSnapshot solid = session_->solid();
    std::vector<Dexel> mine, theirs;
    for (const DexelSnapshot& field : solid.fields) {
      const DexelField* own = copy_->block().field(field.grid().axis);
      const Bounds box = grown(tool_bounds(*copy_->block().tool(1), {tip, {0, 0, 1}}), 3);
      tiles_through(field.grid(), box.lo_mm, box.hi_mm).all_of([&](TileIndex at) {
        const auto tile = own->fresh(at);
        for (int n = 0; n < kTileColumns; ++n) {
          tile->read(n, mine);
          const auto column = field.column(at.x * kTileSide + n % kTileSide,
                                           at.y * kTileSide + n / kTileSide, theirs);
          const bool equal = std::ranges::equal(mine, column);
          EXPECT_TRUE(equal) << "column " << n << " of tile " << at.x << ' ' << at.y;
          if (!equal) return false;
        }
        return true;
      });
    }
  }

  std::shared_ptr<Session> session_;
  ParticipantId hand_ = 0, other_ = 0;
  std::optional<Replica> copy_;
  std::deque<wire::MotionSample> way_;
  std::size_t delay = 0;
  double samples_most = 1e12;
  std::uint64_t other_sequence_ = 0;
  wire::Result theirs_;
  int blocks_ = 0;
};

Vec3 winding(int n) {
  const double a = 0.02 * n;
  return {12 * std::cos(a), 12 * std::sin(1.7 * a), -3 - 2 * std::sin(0.31 * a)};
}

TEST_P(ReplicaRoom, AnswersWhatTheServerWillAnswer) {
  begin(GetParam());
  int answered = 0, pushed = 0;
  for (int n = 0; n < 600; ++n) {
    const Vec3 lean{0.3 * std::sin(0.01 * n), 0.2, 1};
    const auto mine = hand(winding(n), lean * (1 / length(lean)));
    if (!mine) continue;
    ++answered;
    pushed += mine->force_n != Vec3f{};
    EXPECT_EQ(mine->force_n, theirs_.force_n) << n;
    EXPECT_EQ(mine->torque_nmm, theirs_.torque_nmm) << n;
    EXPECT_EQ(mine->engaged_area_mm2, theirs_.engaged_area_mm2) << n;
    EXPECT_EQ(mine->cut_centre_mm, theirs_.cut_centre_mm) << n;
  }
  EXPECT_GT(answered, 590);
  EXPECT_GT(pushed, 500);
  arrive_all();
  EXPECT_EQ(copy_->agreement().error(), 0);
  expect_equal_near(winding(599));
}

TEST_P(ReplicaRoom, AnswersTheSameHoweverFarTheServerIs) {
  begin(GetParam());
  std::vector<Vec3f> near;
  for (int n = 0; n < 400; ++n) {
    const auto mine = hand(winding(n));
    near.push_back(mine ? mine->force_n : Vec3f{});
  }
  delay = 120;
  begin(GetParam());
  int answered = 0, in_a_row = 0;
  for (int n = 0; n < 400; ++n) {
    const auto mine = hand(winding(n));
    in_a_row = mine ? in_a_row + 1 : 0;
    if (!mine) continue;
    // Little is left of what was cut before it was known; in the end only the places where the way
    // is divided differ (TravelQueue). The force is 8 N.
    ++answered;
    const Vec3 error = Vec3(mine->force_n) - Vec3(near[static_cast<std::size_t>(n)]);
    for (const double component : {error.x, error.y, error.z}) {
      EXPECT_NEAR(component, 0, in_a_row <= 30 ? 0.4 : 0.1) << n;
    }
  }
  EXPECT_GT(answered, 200) << "what is near must be known soon after the first patch";
  arrive_all();
  EXPECT_LT(copy_->agreement().error(), 0.05);
}

TEST_P(ReplicaRoom, FollowsWhatOthersCut) {
  begin(GetParam());
  delay = 30;
  for (int n = 0; n < 500; ++n) {
    hand(winding(n));
    other({10 - 0.04 * n, 12 * std::sin(0.03 * n), -5});
  }
  arrive_all();
  expect_equal_near(winding(499));
}

TEST_P(ReplicaRoom, ComesIntoABlockThatWasCarvedBefore) {
  begin(GetParam());
  for (int n = 0; n < 300; ++n) other(winding(n) - Vec3{0, 0, 3});
  for (int n = 0; n < 300; ++n) {
    const auto mine = hand(winding(n));
    if (mine) {
      EXPECT_EQ(mine->force_n, theirs_.force_n) << n;
    }
  }
  arrive_all();
  expect_equal_near(winding(299));
}

TEST_P(ReplicaRoom, KeepsItsOwnCutsAfterAReset) {
  begin(GetParam());
  delay = 50;
  for (int n = 0; n < 200; ++n) hand(winding(n));
  other(winding(400));
  other(winding(405));
  session_->reset_stock(hand_);
  for (int n = 200; n < 300; ++n) hand(winding(n));
  arrive_all();
  EXPECT_LT(copy_->agreement().error(), 0.05);
  expect_equal_near(winding(299));
}

TEST_P(ReplicaRoom, AMotionThatNobodyTakesIsInNeitherBlock) {
  begin(GetParam());
  hand({-20, 0, -4});
  hand({20, 0, -4});  // 40 m/s
  for (int n = 0; n < 50; ++n) hand({20 - 0.1 * n, 0, -4});
  arrive_all();
  expect_equal_near({15, 0, -4});
}

TEST_P(ReplicaRoom, AMotionThatTheServerAloneRejectsIsHealed) {
  samples_most = 20;
  begin(GetParam());
  for (int n = 0; n < 40; ++n) hand({-10 + 0.5 * n, 0, -4});  // the last ones are too many
  EXPECT_TRUE(theirs_.status & wire::kStatusRejected);
  while ((theirs_.status & wire::kStatusRejected) != 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    hand({9.5, 0, -4});
  }
  arrive_all();
  expect_equal_near({9.5, 0, -4});
}

TEST_P(ReplicaRoom, TilesKnownBeforeAResetAreSentAgain) {
  begin(GetParam());
  for (int n = 0; n < 20; ++n) hand({-20, -20, -1}, {0, 0, 1}, 1, 0);
  ASSERT_TRUE(hand({-20, -20, -1}, {0, 0, 1}, 1, 0));
  for (int n = 0; n < 20; ++n) hand({24, 24, -1}, {0, 0, 1}, 1, 0);
  session_->reset_stock(hand_);
  hand({24, 24, -1}, {0, 0, 1}, 1, 0);
  EXPECT_TRUE(hand({24, 24, -1}, {0, 0, 1}, 1, 0));
  delay = 5;
  EXPECT_FALSE(hand({-20, -20, -1}, {0, 0, 1}, 1, 0));
  arrive_all();
  EXPECT_TRUE(hand({-20, -20, -1}, {0, 0, 1}, 1, 0));
}

TEST_P(ReplicaRoom, FeelsTheStockWhereItsToolDoesNotCut) {
  begin(GetParam());
  for (int n = 0; n < 40; ++n) hand({0, 0, 6 - 0.1 * n}, {0, 0, 1}, 1, 0);
  int touched = 0;
  for (int n = 0; n < 40; ++n) {
    const auto mine = hand({0, 0, 1 - 0.1 * n}, {0, 0, 1}, 1, 0);
    ASSERT_TRUE(mine);
    EXPECT_EQ(mine->plane_count, theirs_.plane_count);
    EXPECT_EQ(mine->force_n, theirs_.force_n);
    touched += mine->force_n.z > 0;
  }
  EXPECT_GT(touched, 20);
}

TEST_P(ReplicaRoom, FeelsAShankAgainstAWall) {
  begin(GetParam());
  for (int n = 0; n < 400; ++n) {
    const auto mine = hand({-34 + 0.1 * n, 0, -19}, {0, 0, 1}, 2);
    if (!mine) continue;
    EXPECT_EQ(mine->plane_count, theirs_.plane_count) << n;
    EXPECT_EQ(mine->collision_force_n, theirs_.collision_force_n) << n;
  }
}

TEST_P(ReplicaRoom, OnlyPatchesThatWereSentAreAcknowledged) {
  begin(GetParam());
  EXPECT_EQ(session_->ack_stock(other_, 1).error().code, wire::ErrorCode::kBadMessage);
  EXPECT_EQ(session_->ack_stock(hand_, 1).error().code, wire::ErrorCode::kBadSequence);
  EXPECT_FALSE(session_->stock_update(other_)) << "who keeps no copy is told nothing";
  hand({0, 0, 2});
  EXPECT_TRUE(session_->ack_stock(hand_, 1));
}

INSTANTIATE_TEST_SUITE_P(Rays, ReplicaRoom, testing::Values("dexel", "tri-dexel"));

TEST_F(SessionTest, ACopyAnswersNothingWhereItKnowsNothing) {
  const auto session = start();
  auto source = BlockSource::read(welcome_of(session->scene()));
  ASSERT_TRUE(source);
  Replica copy(*std::move(source));
  EXPECT_FALSE(copy.move(next(0, 0, -1)));
  EXPECT_FALSE(copy.move(next(0.1, 0, -1)));
  EXPECT_EQ(copy.tiles_known(), 0U);
  Replica beside(*BlockSource::read(welcome_of(session->scene())));
  EXPECT_TRUE(beside.move(next(60, 0, -1))) << "beside the block there is nothing to know";
}

TEST_F(SessionTest, ACopyTakesNothingThatIsNoTile) {
  const auto session = start();
  Replica copy(*BlockSource::read(welcome_of(session->scene())));
  const std::uint64_t before = SolidSnapshot(session->solid()).hash();
  const std::array<std::byte, 1> garbage{std::byte{3}};
  wire::StockPatch patch;
  patch.tiles = {{2, 1, 1, garbage}};
  EXPECT_FALSE(copy.take(patch));
  for (const wire::StockTile& tile :
       {wire::StockTile{2, 99, 0, {}}, wire::StockTile{2, 0xFFFFFFFF, 0, {}},
        wire::StockTile{0, 0, 0, {}}}) {
    patch.tiles = {tile};
    EXPECT_FALSE(copy.take(patch));
  }
  EXPECT_EQ(copy.tiles_known(), 0U);
  EXPECT_EQ(copy.block().field(RayAxis::kZ)->find({1, 1}), nullptr);
  EXPECT_EQ(SolidSnapshot(session->solid()).hash(), before);
}

TEST_F(SessionTest, NoCopyIsMadeOfAWelcomeThatSaysTooLittle) {
  const auto session = start();
  EXPECT_FALSE(BlockSource::read("{}"));
  EXPECT_FALSE(BlockSource::read("not json"));
  std::string text = welcome_of(session->scene());
  text.replace(text.find("\"ball\""), 6, "\"spoon\"");
  const auto source = BlockSource::read(text);
  ASSERT_FALSE(source);
  EXPECT_NE(source.error().find("spoon"), std::string::npos) << source.error();
}

TEST(Agreement, DoubtsACopyThatStaysWrong) {
  Agreement agreement;
  wire::Result mine, theirs;
  const auto say = [&](float my_n, float their_n, int times) {
    for (int n = 0; n < times; ++n) {
      mine.agent_time_us = theirs.agent_time_us = mine.agent_time_us + 1000;
      mine.force_n = {my_n, 0, 0};
      theirs.force_n = {their_n, 0, 0};
      agreement.note(mine);
      agreement.compare(theirs);
    }
  };
  say(1.0F, 1.1F, 3000);
  EXPECT_FALSE(agreement.take_doubt());
  say(0.0F, 1.0F, 900);  // what somebody else has cut is news for a while
  say(1.0F, 1.0F, 100);
  EXPECT_TRUE(agreement.take_doubt());
  EXPECT_FALSE(agreement.take_doubt()) << "once";
  say(0.03F, 0.0F, 2000);
  EXPECT_FALSE(agreement.take_doubt()) << "too little to matter";
}

TEST(Agreement, ComparesWhatAnswersTheSameSample) {
  Agreement agreement;
  for (std::uint64_t n = 1; n <= 5000; ++n) {
    wire::Result mine;
    mine.agent_time_us = 1000 * n;
    mine.force_n = {static_cast<float>(n), 0, 0};
    agreement.note(mine);
    if (n <= 1000) continue;
    wire::Result theirs;  // a second late
    theirs.agent_time_us = 1000 * (n - 1000);
    theirs.force_n = {static_cast<float>(n - 1000), 0, 0};
    agreement.compare(theirs);
  }
  EXPECT_EQ(agreement.compared(), 4000U);
  EXPECT_EQ(agreement.error(), 0);
  wire::Result unknown;
  unknown.agent_time_us = 999;
  agreement.compare(unknown);
  EXPECT_EQ(agreement.compared(), 4000U);
}

}  // namespace
}  // namespace kerf
