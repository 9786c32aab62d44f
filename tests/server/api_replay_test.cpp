// SPDX-License-Identifier: Apache-2.0
// Replays of a journal by a page, from the server's responses.
#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "server/feed/column_digest.h"
#include "server/session/hash_text.h"
#include "tests/server/api_rights_fixture.h"
#include "web/wasm/files/journal_block.h"

namespace kerf::net::api_replay_test {
namespace {

using page::JournalBlock;

class ApiReplay : public ApiRightsTest {
 protected:
  const std::string kSession = "/v1/sessions/block/";

  void move(ParticipantId id, Vec3 tip, bool cuts, std::uint64_t after_ms) {
    wire::MotionSample sample{.agent_sequence = ++sequences_[id],
                              .time_us = 1000 * (time_ms_ += after_ms),
                              .tip_mm = tip,
                              .tool_id = 1,
                              .buttons = cuts ? wire::kButtonCutting : 0};
    sent_.push_back(sample);
    ASSERT_TRUE(session->move(id, {&sample, 1}).rejections.empty());
  }
  /// Returns the samples sent by move() since the last call.
  std::vector<wire::MotionSample> take_sent() { return std::exchange(sent_, {}); }
  void stroke(ParticipantId id, Vec3 from, Vec3 to) {
    constexpr int kSteps = 30;
    move(id, from + Vec3{0, 0, 10}, false, 1000);
    move(id, from, false, 1000);
    for (int n = 1; n <= kSteps; ++n) move(id, from + (to - from) * (1.0 * n / kSteps), true, 2);
    move(id, to + Vec3{0, 0, 10}, false, 1000);
  }
  void carve() {
    const ParticipantId ada = join(tokens[Role::kSculptor]), bo = join(tokens[Role::kOwner]);
    stroke(ada, {-15, 0, -2}, {15, 0, -2});
    stroke(bo, {0, -15, -3}, {0, 15, -3});
    made("POST", kSession + "undo?participant=" + std::to_string(ada), tokens[Role::kOwner]);
    stroke(bo, {-15, 8, -2}, {15, 8, -2});
    made("POST", kSession + "redo?participant=" + std::to_string(ada), tokens[Role::kOwner]);
    stroke(ada, {-15, -8, -4}, {15, -8, -1});
  }
  Json state() { return made("GET", kSession + "replay", tokens[Role::kWatcher]); }
  std::string bytes(const std::string& target) {
    const ApiResponse response = ask("GET", kSession + target, tokens[Role::kWatcher]);
    EXPECT_EQ(response.status, 200U) << target << response.body;
    const std::pair<std::string, std::string> lasts("Cache-Control",
                                                    "private, max-age=31536000, immutable");
    EXPECT_EQ(std::ranges::count(response.headers, lasts), 1);
    return response.body;
  }
  static std::span<const std::byte> as_bytes(const std::string& text) {
    return std::as_bytes(std::span(text));
  }
  std::string records(const Json& state, std::uint64_t first, std::uint64_t last) {
    return bytes("records?journal=" + std::string(state.at("journal")) +
                 "&first=" + std::to_string(first) + "&last=" + std::to_string(last));
  }
  /// Goes to a record as the page does, which carves the rest after a seek.
  static void go(JournalBlock& block, std::uint64_t record, bool feels) {
    ASSERT_TRUE(block.seek(record));
    const std::uint64_t at = Json::parse(block.progress()).at("carved");
    ASSERT_LE(at, record);
    ASSERT_TRUE(block.carve(record - at, feels));
  }
  JournalBlock read(const Json& state) {
    auto block =
        JournalBlock::read(as_bytes(bytes("origin?journal=" + std::string(state.at("journal")))));
    EXPECT_TRUE(block) << block.error();
    return *std::move(block);
  }
  /// Returns the block with all records of that state, not carved yet.
  JournalBlock made_block(const Json& state) {
    JournalBlock block = read(state);
    const auto added = block.add(as_bytes(records(state, 1, state.at("record"))));
    EXPECT_TRUE(added) << added.error();
    EXPECT_TRUE(block.make());
    return block;
  }

 private:
  std::vector<wire::MotionSample> sent_;
  std::map<ParticipantId, std::uint64_t> sequences_;
  std::uint64_t time_ms_ = 0;
};

TEST_F(ApiReplay, SpansOfAnyLengthReplayToTheServersState) {
  carve();
  const Json now = state();
  const std::uint64_t last = now.at("record");
  ASSERT_GT(last, 100U);
  for (const std::uint64_t length : {std::uint64_t{7}, std::uint64_t{50}, last}) {
    JournalBlock block = read(now);
    for (std::uint64_t first = 1; first <= last; first += length) {
      const auto added =
          block.add(as_bytes(records(now, first, std::min(last, first + length - 1))));
      ASSERT_TRUE(added) << added.error();
    }
    ASSERT_TRUE(block.make());
    ASSERT_TRUE(block.carve(last, false));
    EXPECT_EQ(hash_text(block.hash()), now.at("state_hash"));
  }
}

TEST_F(ApiReplay, SeeksReachAnyRecordToTheBitAtAnySpeed) {
  carve();
  const Json now = state();
  const std::uint64_t last = now.at("record");
  JournalBlock block = made_block(now);
  std::mt19937 random(5);
  SerialWorkers alone;
  for (int n = 0; n < 8; ++n) {
    const std::uint64_t record = n == 0 ? 0 : random() % last;
    go(block, random() % (last + 1), true);
    go(block, record, n % 2 == 0);
    const auto there = session->past().solid_at(record, alone, {});
    ASSERT_TRUE(there && *there);
    EXPECT_EQ(block.hash(), (*there)->hash()) << record;
  }
}

TEST_F(ApiReplay, ChangedTilesAreAvailableAtOnce) {
  carve();
  const Json now = state();
  const std::uint64_t last = now.at("record");
  JournalBlock block = made_block(now);
  std::map<TileIndex, std::vector<std::array<float, 3>>> shown;
  std::mt19937 random(7);
  for (int n = 0; n < 8; ++n) {
    go(block, random() % (last + 1), false);
    for (const TileIndex tile : block.changed()) shown[tile] = block.mesh(tile).positions_mm;
    ASSERT_FALSE(shown.empty());
    for (const auto& [tile, positions_mm] : shown) {
      EXPECT_EQ(block.mesh(tile).positions_mm, positions_mm) << tile.x << ", " << tile.y;
    }
  }
}

TEST_F(ApiReplay, DigestsEqualThoseOfTheServer) {
  carve();  // with an undo and a redo
  const Json now = state();
  const std::uint64_t last = now.at("record");
  JournalBlock block = made_block(now);
  go(block, last / 2, false);
  std::map<TileIndex, std::uint64_t> digests;
  const auto take = [&] {
    for (const TileIndex tile : block.changed()) digests[tile] = block.digest(tile);
  };
  take();
  const auto before = digests;
  go(block, last, false);
  take();
  EXPECT_NE(digests, before);
  const SolidSnapshot solid = session->solid();
  for (const auto& [tile, digest] : digests) EXPECT_EQ(digest, column_digest(solid, tile));
  EXPECT_EQ(digests.size(),
            static_cast<std::size_t>(solid.grid().tiles_x() * solid.grid().tiles_y()));
}

TEST_F(ApiReplay, StoredHashesMatchTheirRecords) {
  for (int n = 0; n < 3; ++n) {
    carve();
    state();  // stores the hash
  }
  const Json now = state();
  const std::string journal = "journal=" + std::string(now.at("journal"));
  const auto hashes = [&](const std::string& span) -> Json {
    const Json body = made("GET", kSession + "hashes?" + journal + span, tokens[Role::kWatcher]);
    return body.at("hashes");
  };
  const Json all = hashes("");
  ASSERT_GE(all.size(), 3U);
  EXPECT_EQ(all.back().at("record"), now.at("record"));
  EXPECT_EQ(all.back().at("state_hash"), now.at("state_hash"));
  JournalBlock block = made_block(now);
  for (const Json& each : all) {
    go(block, each.at("record"), false);
    EXPECT_EQ(hash_text(block.hash()), each.at("state_hash")) << each;
    const std::string at = "replay?at=" + std::to_string(std::uint64_t{each.at("record")});
    const Json then = made("GET", kSession + at, tokens[Role::kWatcher]);
    EXPECT_EQ(then.at("record"), each.at("record"));
    EXPECT_EQ(then.at("state_hash"), each.at("state_hash"));
  }
  const std::uint64_t second = all.at(1).at("record");
  const Json part = hashes("&first=" + std::to_string(second) +
                           "&last=" + std::to_string(std::uint64_t{now.at("record")} - 1));
  ASSERT_EQ(part.size(), all.size() - 2);
  EXPECT_EQ(part.front().at("record"), second);
}

TEST_F(ApiReplay, LaterRecordsAreAppended) {
  carve();
  const Json before = state();
  JournalBlock block = made_block(before);
  ASSERT_TRUE(block.carve(before.at("record"), false));
  stroke(join(tokens[Role::kSculptor]), {-15, 12, -3}, {15, 12, -3});
  const Json now = state();
  ASSERT_GT(now.at("record"), before.at("record"));
  ASSERT_TRUE(block.add(as_bytes(records(now, before.at("record"), now.at("record")))));
  ASSERT_TRUE(block.carve(20, true));
  const Json progress = Json::parse(block.progress());
  EXPECT_GT(progress.at("tools").at(0).at("removed_rate_mm3_per_s"), 0);
  ASSERT_TRUE(block.carve(1000, true));
  EXPECT_EQ(hash_text(block.hash()), now.at("state_hash"));
}

TEST_F(ApiReplay, HandCarvesInThePageLikeInASession) {
  carve();
  const Json before = state();
  const std::uint64_t last = before.at("record");
  JournalBlock block = made_block(before);
  const ParticipantId eve = join(tokens[Role::kSculptor]);
  const auto here = [&] { return hash_text(block.hash()); };
  const auto there = [&] { return std::string(state().at("state_hash")); };
  const auto change = [&](const std::string& verb) {
    made("POST", kSession + verb + "?participant=" + std::to_string(eve), tokens[Role::kOwner]);
    ASSERT_TRUE(block.change_by_hand(verb == "undo", 0)) << verb;
  };
  block.begin_hand(eve);
  take_sent();
  stroke(eve, {-15, 2, -5}, {15, -3, -5});
  EXPECT_FALSE(block.carve_by_hand(take_sent(), 0, 0)) << "the block is not at its last record";
  EXPECT_EQ(block.change_by_hand(true, 0).error().find("the block is at record 0 of"), 0U);
  ASSERT_TRUE(block.carve(last, false));
  EXPECT_EQ(block.change_by_hand(true, 0).error(), "there is no stroke to undo");
  EXPECT_EQ(here(), before.at("state_hash"));

  made("POST", kSession + "undo?participant=" + std::to_string(eve), tokens[Role::kOwner]);
  EXPECT_EQ(there(), here());
  stroke(eve, {-15, 2, -5}, {15, -3, -5});
  ASSERT_TRUE(block.carve_by_hand(take_sent(), 0, 0));
  EXPECT_EQ(here(), there());
  const std::string first = here();
  EXPECT_NE(first, before.at("state_hash"));
  stroke(eve, {-12, -12, -3}, {12, 12, -4});
  ASSERT_TRUE(block.carve_by_hand(take_sent(), 0, 0));
  EXPECT_EQ(here(), there());
  for (const char* verb : {"undo", "undo", "redo", "redo", "undo"}) {
    change(verb);
    EXPECT_EQ(here(), there()) << verb;
  }
  EXPECT_EQ(here(), first);

  // A redo ends the stroke in progress, so that an undo then only undoes its second part.
  move(eve, {-10, 12, -2}, false, 1000);
  move(eve, {0, 12, -2}, true, 100);
  ASSERT_TRUE(block.carve_by_hand(take_sent(), 0, 0));
  change("undo");
  move(eve, {-10, -14, -3}, false, 1000);
  move(eve, {0, -14, -3}, true, 100);
  ASSERT_TRUE(block.carve_by_hand(take_sent(), 0, 0));
  change("redo");
  move(eve, {10, -14, -3}, true, 100);
  ASSERT_TRUE(block.carve_by_hand(take_sent(), 0, 0));
  EXPECT_EQ(here(), there());
  change("undo");
  EXPECT_EQ(here(), there());

  // A page saves the journal of the same block.
  auto saved = JournalBlock::read(block.origin());
  ASSERT_TRUE(saved) << saved.error();
  ASSERT_TRUE(saved->add(block.rows()));
  ASSERT_TRUE(saved->make());
  ASSERT_TRUE(saved->carve(10'000, false));
  EXPECT_EQ(saved->hash(), block.hash());
}

TEST_F(ApiReplay, HandRejectsTheSameSamplesAsASession) {
  carve();
  const Json now = state();
  JournalBlock block = made_block(now);
  ASSERT_TRUE(block.carve(now.at("record"), false));
  block.begin_hand(99);
  wire::MotionSample sample{.agent_sequence = 1,
                            .time_us = 1000,
                            .tip_mm = {0, 0, -4},
                            .tool_id = 1,
                            .buttons = wire::kButtonCutting};
  std::vector<wire::MotionSample> samples(3, sample);
  samples[1].time_us = 2000;
  samples[1].tool_id = 77;  // there is no such tool
  samples[2].time_us = 3000;
  samples[2].tip_mm.x = 5;
  const auto done = block.carve_by_hand(samples, 0, 0);
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().find("77"), std::string::npos) << done.error();
  EXPECT_NE(hash_text(block.hash()), now.at("state_hash")) << "the third sample is carved";
}

TEST_F(ApiReplay, InvalidRequestsAreRejected) {
  carve();
  const Json now = state();
  const std::uint64_t last = now.at("record");
  const std::string journal = "journal=" + std::string(now.at("journal"));
  const auto code = [&](const std::string& target, unsigned status) {
    return std::string(
        made("GET", kSession + target, tokens[Role::kOwner], status).at("error").at("code"));
  };
  EXPECT_EQ(code("records?" + journal + "&first=1&last=" + std::to_string(last + 1), 404),
            "no_record");
  EXPECT_EQ(code("records?" + journal + "&first=0&last=5", 400), "bad_span");
  EXPECT_EQ(code("records?" + journal + "&first=5&last=4", 400), "bad_span");
  EXPECT_EQ(code("records?" + journal + "&first=1&last=65537", 400), "bad_span");
  EXPECT_EQ(code("records?journal=0123&first=1&last=5", 404), "other_journal");
  EXPECT_EQ(code("hashes?journal=0123", 404), "other_journal");
  EXPECT_EQ(code("hashes?" + journal + "&first=5&last=4", 400), "bad_span");
  EXPECT_EQ(code("replay?at=" + std::to_string(last + 1), 404), "no_record");
  EXPECT_EQ(code("records?first=1&last=5", 404), "other_journal");
  EXPECT_EQ(code("origin?journal=0123", 404), "other_journal");
  for (const char* target : {"replay", "origin", "records", "hashes"}) {
    EXPECT_EQ(ask("GET", kSession + target, "").status, 401U) << target;
  }
}

TEST_F(ApiReplay, DamagedSpanIsDetectedBeforeItIsCarved) {
  carve();
  const Json now = state();
  const std::string whole = records(now, 1, now.at("record"));
  std::string flipped = whole;
  flipped[flipped.size() / 2] ^= 4;
  for (const std::string& bad : {flipped, whole.substr(0, whole.size() - 1)}) {
    JournalBlock block = read(now);
    const auto added = block.add(as_bytes(bad));
    ASSERT_TRUE(block.make());
    const auto carved = block.carve(now.at("record"), false);
    EXPECT_TRUE(!added || !carved);
    EXPECT_NE(hash_text(block.hash()), now.at("state_hash"));
  }
  JournalBlock block = read(now);
  const std::string late = records(now, 100, now.at("record"));
  if (late.size() < whole.size()) {
    EXPECT_FALSE(block.add(as_bytes(late)));
  }
  EXPECT_FALSE(JournalBlock::read(as_bytes("short")));
}

}  // namespace
}  // namespace kerf::net::api_replay_test
