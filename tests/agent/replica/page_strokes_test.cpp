// SPDX-License-Identifier: Apache-2.0
// A page that carves, undoes and redoes, against the session: it displays changes at once, and its
// copy of the block equals the session's to the bit.
#include "kernel/dexel/tile_region.h"
#include "server/wire/codec.h"
#include "tests/server/undo_fixture.h"
#include "tests/support/test.h"
#include "web/wasm/page_block.h"

namespace kerf::page_strokes_test {
namespace {

using page::ChangedTile;
using page::PageBlock;

std::string scene(const std::string& rays, const std::string& box) {
  return R"({"name": "page", "stock": {"shape": "box", )" + box + R"(},
    "accuracy": {"rays": ")" +
         rays + R"(", "pitch_mm": 0.5, "tolerance_mm": 0.01, "motion": "tight"},
    "tools": [{"id": 1, "shape": "ball", "diameter_mm": 6, "length_mm": 30},
              {"id": 2, "shape": "flat", "diameter_mm": 6, "length_mm": 30}]})";
}

constexpr const char* kSmall = R"("min_mm": [-30, -20, -20], "max_mm": [30, 20, 0])";
/// 34 x 34 tiles: more than are sent at once.
constexpr const char* kLarge = R"("min_mm": [-270, -270, -60], "max_mm": [270, 270, 0])";

std::string welcome_of(const Scene& scene) {
  return R"({"stock":)" + stock_json(scene) + R"(,"tools":)" + tools_json(scene) + R"(,"force":)" +
         force_json(scene) + R"(,"accuracy":)" + accuracy_json(scene) + "}";
}

/// Ada carves in a page. Samples, requests, answers and patches are in flight for a while. Bo has
/// no copy.
class PageStrokes : public SessionUndo, public testing::WithParamInterface<const char*> {
 protected:
  struct Request {
    bool undone;
  };
  struct Received {
    std::vector<std::byte> frame;  ///< empty if a request was refused
    std::uint64_t sequence, arrives_ms;
  };

  void begin(const char* box = kSmall) {
    limits_.samples_per_s = limits_.samples_burst = 1e9;  // faster than the real clock
    restart();
    create(scene(GetParam(), box));
    request_.stock = request_.whole = request_.returned = request_.durable = true;
    connect();
    page_.emplace(PageBlock::open(welcome_of(*session_->scene())).value());
    bo_ = join("Bo");
  }
  void connect() {
    const Admission admission = session_->admit(request_).value();
    ada_ = admission.participant.id;
    request_.token = admission.token;
  }
  /// Breaks the line: data in transit is lost, and samples are resent. The page continues to cut
  /// when it has the server's stock.
  void reconnect() {
    received_.clear();
    std::erase_if(sent_, [](const auto& one) { return std::holds_alternative<Request>(one); });
    connect();
    arrive_all();
  }
  void ada(Vec3 tip, bool cuts = true, ToolId tool = 1) {
    wire::MotionSample sample = next(ada_, tip, cuts);
    sample.tool_id = tool;
    wire::MotionBatch batch{.count = 1};
    batch.samples[0] = sample;
    std::vector<std::byte> frame;
    wire::append(frame, {}, batch);
    EXPECT_TRUE(page_->take(frame));
    sent_.push_back(sample);
    pass();
  }
  void ada_asks(bool undone) {
    page_->change(undone);
    sent_.push_back(Request{undone});
  }
  /// A stroke of the page along a line, from above the block and back.
  void ada_strokes(Vec3 from, Vec3 to, int steps = 12) {
    for (int n = 8; n > 0; n -= 2) ada(from + Vec3{0, 0, 1.0 * n}, false);
    for (int n = 0; n <= steps; ++n) ada(from + (to - from) * (double(n) / steps));
    for (int n = 2; n <= 8; n += 2) ada(to + Vec3{0, 0, 1.0 * n}, false);
  }
  void pass() {
    while (sent_.size() > delay_) arrive();
    deliver(time_ms_);
  }
  void arrive() {
    if (const auto* sample = std::get_if<wire::MotionSample>(&sent_.front())) {
      for (const Rejection& rejection : session_->move(ada_, {sample, 1}).rejections) {
        EXPECT_EQ(rejection.code, wire::ErrorCode::kInStock);
      }
      sent_.pop_front();
    } else {
      const bool undone = std::get<Request>(sent_.front()).undone;
      sent_.pop_front();
      const auto done =
          change({.undone = undone, .participant = ada_, .author = ada_, .caller = {}});
      if (!done) received_.push_back({{}, 0, time_ms_ + delay_});
    }
    send_patch();
  }
  bool send_patch() {
    const auto update = session_->replicas().update(ada_);
    if (!update) return false;
    received_.push_back({{}, update->sequence, time_ms_ + delay_});
    wire::append(received_.back().frame, {}, update->patch());
    return true;
  }
  void deliver(std::uint64_t until_ms) {
    while (!received_.empty() && received_.front().arrives_ms <= until_ms) {
      const Received now = std::move(received_.front());
      received_.pop_front();
      if (now.frame.empty()) {
        page_->settle();
        continue;
      }
      EXPECT_TRUE(page_->take(now.frame));
      EXPECT_TRUE(session_->replicas().ack(ada_, now.sequence));
    }
  }
  void arrive_all() {
    while (!sent_.empty()) arrive();
    do {
      deliver(UINT64_MAX);
    } while (send_patch());
  }
  void expect_equal() {
    arrive_all();
    page_->settle();
    EXPECT_EQ(page_->hash(), hash());
    EXPECT_EQ(page_->surface_hash(), hash());
  }
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 4294967296.0);
  }
  Vec3 place() { return {uniform(-25, 25), uniform(-15, 15), uniform(-5, -1)}; }

  std::mt19937 random_{11};
  JoinRequest request_{ParticipantKind::kAgent, "Ada", "", 1, true};
  ParticipantId ada_ = 0, bo_ = 0;
  std::optional<PageBlock> page_;
  std::deque<std::variant<wire::MotionSample, Request>> sent_;
  std::deque<Received> received_;
  std::size_t delay_ = 0;
};

TEST_P(PageStrokes, UndoAndRedoAreDisplayedAheadOfTheServer) {
  begin();
  ada_strokes({-20, 0, -2}, {-10, 4, -2});
  expect_equal();
  std::vector<std::uint64_t> hashes{hash()};
  for (const double x : {0.0, 2.0, 14.0}) {
    ada_strokes({x, -5, -3}, {x + 4, 5, -4});
    expect_equal();
    hashes.push_back(hash());
  }
  delay_ = 1000;  // no data arrives
  (void)page_->changed();
  for (int n = 2; n >= 0; --n) {
    ada_asks(true);
    EXPECT_EQ(page_->surface_hash(), hashes[std::size_t(n)]);
    const auto changed = page_->changed();
    EXPECT_FALSE(changed.empty());
    for (const ChangedTile& tile : changed) EXPECT_EQ(tile.by_page, 1);
  }
  for (int n = 1; n <= 2; ++n) {
    ada_asks(false);
    EXPECT_EQ(page_->surface_hash(), hashes[std::size_t(n)]);
  }
  EXPECT_EQ(page_->hash(), hashes[3]) << "the state is the server's";
  ada_strokes({-5, 10, -2}, {5, 10, -2});
  const std::uint64_t expected = page_->surface_hash();
  (void)page_->changed();
  arrive_all();
  EXPECT_EQ(hash(), expected);
  EXPECT_TRUE(page_->changed().empty()) << "the server's answers change nothing";
  expect_equal();
}

TEST_P(PageStrokes, UndoKeepsLaterCutsOfOthers) {
  begin();
  ada_strokes({-20, 0, -2}, {20, 0, -2}, 40);
  expect_equal();
  const std::uint64_t before = never_happened(0);
  stroke(bo_, {-10, 6, -4}, {10, 6, -4});  // next to the stroke, in the same tiles
  arrive_all();
  delay_ = 1000;
  ada_asks(true);
  const std::uint64_t expected = page_->surface_hash();
  EXPECT_NE(expected, before);
  const StrokeId later = stroke(bo_, {-10, -7, -4}, {10, -7, -4});
  arrive_all();
  expect_equal();
  EXPECT_NE(hash(), expected);
  undo({later});
  EXPECT_EQ(hash(), expected);
  expect_equal();
}

TEST_P(PageStrokes, UndoRefusedByTheServerIsReverted) {
  begin();
  ada_strokes({-20, 0, -2}, {-10, 4, -2});
  expect_equal();
  const std::uint64_t cut = hash();
  undo({session_->sequence() - 12});  // an owner is faster
  const std::uint64_t uncut = hash();
  delay_ = 1000;
  ada_asks(true);
  EXPECT_EQ(page_->hash(), cut);
  EXPECT_EQ(page_->surface_hash(), uncut);
  expect_equal();
  EXPECT_EQ(page_->hash(), uncut);
}

TEST_P(PageStrokes, CopyEqualsTheServerAfterRandomStrokesUndoLossAndReconnects) {
  begin();
  std::vector<StrokeId> done;
  for (int round = 0; round < 24; ++round) {
    delay_ = random_() % 60;
    const Vec3 from = place(), to = from + Vec3{uniform(-9, 9), uniform(-9, 9), uniform(-1, 1)};
    ada_strokes(from, to, 6 + int(random_() % 16));
    for (auto asks = random_() % 4; asks > 0; --asks) {
      ada_asks(random_() % 3 != 0);
      const Vec3 next_to = place();
      if (random_() % 2 == 0) ada_strokes(next_to, next_to + Vec3{uniform(-9, 9), 5, 0}, 8);
      if (random_() % 3 == 0) (void)page_->changed();
    }
    if (random_() % 2 == 0) {
      const Vec3 beside = from + Vec3{uniform(-6, 6), uniform(-6, 6), uniform(-2, 1)};
      done.push_back(stroke(bo_, beside, beside + Vec3{uniform(-8, 8), uniform(-8, 8), 0}, 10));
    }
    if (random_() % 4 == 0 && !done.empty()) {
      undo({done.back()});
      done.pop_back();
    }
    if (random_() % 6 == 0) reconnect();
    if (round % 3 == 2) expect_equal();
    ASSERT_FALSE(HasFailure()) << "round " << round;
  }
}

TEST_P(PageStrokes, ACutBetweenTheRaysAlongZIsDisplayed) {
  begin();
  ada({0.05, 0.05, 5}, false, 2);
  arrive_all();
  for (int n = 0; n <= 10; ++n) ada({0.05, 0.05, 5.0 - n}, true, 2);
  const auto along_z = [&] { return session_->solid().fields.front().hash(); };
  const std::uint64_t before = along_z();
  (void)page_->changed();
  ada({0.053, 0.05, -5}, true, 2);
  EXPECT_EQ(along_z(), before);
  if (session_->solid().fields.size() == 1) return;
  const auto changed = page_->changed();
  EXPECT_FALSE(changed.empty());
  for (const ChangedTile& tile : changed) EXPECT_EQ(tile.by_page, 1);
  ada_asks(true);
  expect_equal();
}

TEST_P(PageStrokes, LargeBlockIsDisplayedAroundTheCut) {
  begin(kLarge);
  for (const double x : {-200.0, 0.0, 200.0}) {
    for (int n = 0; n < 3; ++n) ada({x, 100, 5}, false);
    arrive_all();
    (void)page_->changed();
    delay_ = 1000;  // no data arrives
    ada_strokes({x, 100, -2}, {x + 8, 100, -2});
    std::vector<TileIndex> tiles;
    for (const ChangedTile& tile : page_->changed()) {
      if (tile.by_page != 0) tiles.push_back(tile.at);
    }
    const DexelGrid grid = session_->solid().grid();
    const TileRegion cut = tiles_through(grid, {x - 3, 97, -1}, {x + 11, 103, -1});
    cut.all_of([&](TileIndex at) {
      EXPECT_EQ(std::ranges::count(tiles, at), 1) << x << ": " << at.x << ' ' << at.y;
      return true;
    });
    delay_ = 0;
    arrive_all();
  }
}

INSTANTIATE_TEST_SUITE_P(Rays, PageStrokes, testing::Values("dexel", "tri-dexel"));

}  // namespace
}  // namespace kerf::page_strokes_test
