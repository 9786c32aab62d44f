// SPDX-License-Identifier: Apache-2.0
// Tools that are made in a session: how they reach motions, restarts, branches, followers, exports
// and looks back.
#include "server/session/session_tools.h"

#include "server/session/past_block.h"
#include "server/session/session_past_source.h"
#include "server/store/journal_change.h"
#include "server/store/journal_file.h"
#include "server/threads/io_threads.h"
#include "server/threads/run_and_wait.h"
#include "tests/server/export_fixture.h"
#include "tests/support/test.h"

namespace kerf::session_tools_test {
namespace {

constexpr const char* kWide = R"({"shape": "bull_nose", "diameter_mm": 14,
    "corner_radius_mm": 2, "length_mm": 50})";
/// Its chord tolerance follows the scene's tolerance_mm.
constexpr const char* kRound = R"({"shape": "profile",
    "profile_mm": [[0, 0], {"to": [3, 3], "radius": 3}, [3, 40]]})";

class SessionToolsTest : public SessionExport {
 protected:
  static SceneTool tool(const std::string& json) {
    return test::value_of(parse_scene_tool(json, 0.01));
  }
  /// Ends the server and executes a statement in the session's journal.
  void change_journal(const std::string& sql) {
    ASSERT_TRUE(session_->flush());
    const auto file = session_->journal_file();
    session_.reset();
    registry_.reset();
    auto journal = test::value_of(open_journal(file, SqlMode::kWrite));
    ASSERT_TRUE(journal.execute(sql));
  }
  static SceneTool ball(double diameter_mm) {
    return tool(R"({"shape": "ball", "length_mm": 59, "diameter_mm": )" +
                std::to_string(diameter_mm) + "}");
  }
  SessionTools::Answer make(const std::string& json) {
    return test::value_of(session_->tools().make(tool(json), "Ada"));
  }
  /// Cuts a stroke with a tool.
  StrokeId stroke_with(ToolId id, ParticipantId hand, Vec3 from, Vec3 to) {
    wire::MotionSample sample = next(hand, from, false);
    const std::uint64_t first = session_->sequence() + 1;
    for (int n = 0; n <= 20; ++n) {
      sample = next(hand, from + (to - from) * (n / 20.0), n > 0);
      sample.tool_id = id;
      EXPECT_TRUE(session_->move(hand, {&sample, 1}).rejections.empty());
    }
    sample = next(hand, to + Vec3{0, 0, 10}, false);
    session_->move(hand, {&sample, 1});
    return first;
  }
  /// Strokes with tools that are made between them, one undone.
  void carve() {
    create();
    const ParticipantId ada = join("Ada"), bo = join("Bo");
    stroke(ada, {-15, 0, -2}, {15, 0, -2});
    before_ = session_->sequence();
    wide_ = make(kWide).id;
    first_ = stroke_with(wide_, ada, {-15, 8, -2}, {15, 8, -2});
    round_ = make(kRound).id;
    second_ = stroke_with(round_, bo, {-15, -8, -4}, {15, -8, -1});
    undo({first_});
    stroke_with(wide_, bo, {0, -15, -3}, {0, 15, -3});
    EXPECT_EQ(hash(), never_happened());
  }

  std::uint64_t before_ = 0;  ///< the last record before a tool was made
  ToolId wide_ = 0, round_ = 0;
  StrokeId first_ = 0, second_ = 0;
};

TEST_F(SessionToolsTest, CutAtOnceAndAreUndoneAndRedone) {
  carve();
  EXPECT_EQ(wide_, 3U);
  EXPECT_EQ(round_, 4U);
  redo({first_});
  undo({second_});
  EXPECT_EQ(hash(), never_happened());
  EXPECT_EQ(session_->tools().made().at(wide_).author, "Ada");
  EXPECT_EQ(session_->tools().made().at(wide_).record, before_ + 1);
}

TEST_F(SessionToolsTest, SurviveARestartWithAndWithoutASnapshot) {
  carve();
  const std::uint64_t expected = hash();
  const std::string tools = tools_json(*session_->scene());
  for (int round = 0; round < 2; ++round) {
    if (round == 1) session_->finish_journal(true).value();
    reload();
    EXPECT_EQ(hash(), expected);
    EXPECT_EQ(tools_json(*session_->scene()), tools);
    EXPECT_EQ(session_->tools().made().size(), 2U);
    EXPECT_FALSE(make(kRound).is_new);
  }
  const ParticipantId cy = join("Cy");
  redo({first_});
  stroke_with(round_, cy, {-15, 4, -5}, {15, 4, -5});
  EXPECT_EQ(make(R"({"shape": "flat", "diameter_mm": 3, "length_mm": 9})").id, 5U);
  EXPECT_EQ(hash(), never_happened());
}

TEST_F(SessionToolsTest, WithEqualOutlinesAreOne) {
  create();
  EXPECT_EQ(make(R"({"shape": "ball", "diameter_mm": 10, "length_mm": 60})").id, 1U);
  const auto first = make(R"({"id": 77, "shape": "ball", "diameter_mm": 7, "length_mm": 60})");
  EXPECT_TRUE(first.is_new);
  EXPECT_EQ(first.id, 3U) << "the session chooses the id";
  const std::uint64_t records = session_->sequence();
  const auto again = make(R"({"shape": "ball", "diameter_mm": 7, "length_mm": 60})");
  EXPECT_FALSE(again.is_new);
  EXPECT_EQ(again.id, first.id);
  EXPECT_EQ(session_->sequence(), records);
  EXPECT_EQ(make(R"({"shape": "ball", "diameter_mm": 7, "length_mm": 61})").id, 4U);
}

TEST_F(SessionToolsTest, AreLimited) {
  create();
  for (std::size_t n = 2; n < kToolsMax; ++n) {
    ASSERT_TRUE(session_->tools().make(ball(1 + 0.1 * static_cast<double>(n)), ""));
  }
  const auto one_more = session_->tools().make(ball(0.5), "");
  ASSERT_FALSE(one_more);
  EXPECT_STREQ(one_more.error().code, "limit");
  EXPECT_EQ(session_->tools().make(ball(1.2), "")->id, 3U) << "an equal one is there";
  reload();
  EXPECT_EQ(session_->scene()->tools.size(), kToolsMax);
}

TEST_F(SessionToolsTest, ABranchHasThoseOfItsRecords) {
  carve();
  const auto parent = session_;
  const std::uint64_t last = session_->sequence();
  session_ = test::value_of(registry_->branch("early", *parent, before_));
  EXPECT_EQ(session_->scene()->tools.size(), 2U);
  EXPECT_EQ(session_->sequence(), before_);
  EXPECT_EQ(make(kRound).id, 3U);
  stroke_with(3, join("Cy"), {-15, -8, -4}, {15, -8, -1});
  EXPECT_EQ(hash(), never_happened());
  session_ = test::value_of(registry_->branch("fresh", *parent, 0));
  EXPECT_EQ(session_->sequence(), 2U) << "the tools of the scene only";
  session_ = test::value_of(registry_->branch("late", *parent, last));
  EXPECT_EQ(session_->scene()->tools.size(), 4U);
  EXPECT_EQ(hash(), parent->solid().hash());
  redo({first_});
  stroke_with(round_, join("Cy"), {-15, 4, -5}, {15, 4, -5});
  EXPECT_EQ(hash(), never_happened());
}

TEST_F(SessionToolsTest, ExportedProgramsCarveTheSameBlock) {
  carve();
  expect_equal_exports();
}

TEST_F(SessionToolsTest, ALookBackBegunBeforeAToolWasMadePlaysOn) {
  create();
  const ParticipantId ada = join("Ada");
  stroke(ada, {-15, 0, -2}, {15, 0, -2});
  ASSERT_TRUE(session_->flush());
  auto past = test::value_of(PastBlock::create(past_of(session_)));
  const ToolId wide = make(kWide).id;
  const StrokeId first = stroke_with(wide, ada, {-15, 8, -2}, {15, 8, -2});
  ASSERT_TRUE(session_->flush());
  ASSERT_TRUE(test::value_of(past.seek(first, {})));  // past the record that defines the tool
  const auto played =
      past.play({.record = session_->sequence()}, std::chrono::hours(1), std::stop_token());
  ASSERT_TRUE(played) << played.error();
  EXPECT_EQ(past.solid().hash(), hash());
}

TEST_F(SessionToolsTest, AFollowerHasThemAsTheOwner) {
  const test::TemporaryFolder there;
  const auto copied = there / "block.kerf";
  IoThreads behind("behind", 1, 0);
  SessionRegistry servers(
      RegistryOptions{there.path(), 4, limits_, {}, snapshots_},
      [](const std::string& id) { return std::make_shared<IoThreads>(id, 1, 0); }, behind);
  carve();
  ASSERT_TRUE(session_->flush());
  JournalChanges changes(session_->journal_file());
  auto copy = test::value_of(JournalCopy::create(copied));
  for (auto change = changes.next(); *change; change = changes.next()) {
    ASSERT_TRUE(copy.apply(**change));
  }
  (void)test::value_of(copy.finish());
  const auto follower = test::value_of(servers.follow("block"));
  EXPECT_EQ(tools_json(*follower->scene()), tools_json(*session_->scene()));
  // The rows of a later tool arrive while the session is followed.
  make(R"({"shape": "flat", "diameter_mm": 3, "length_mm": 9})");
  ASSERT_TRUE(session_->flush());
  const auto lists = test::value_of(JournalReader::open(session_->journal_file())).lists();
  run_and_wait(follower->executor(), [&] {
    follower->matters().restore(lists);
    return 0;
  });
  EXPECT_EQ(tools_json(*follower->scene()), tools_json(*session_->scene()));
  const auto refused =
      run_and_wait(follower->executor(), [&] { return follower->tools().make(ball(9), ""); });
  EXPECT_FALSE(refused);
  servers.end_following("block", "the test ends");
}

TEST_F(SessionToolsTest, AJournalWithoutTheirTableOpens) {
  create();
  stroke(join("Ada"), {-15, 0, -2}, {15, 0, -2});
  const std::uint64_t expected = hash();
  change_journal("DROP TABLE tools");
  reload();
  EXPECT_EQ(hash(), expected);
  EXPECT_EQ(make(kWide).id, 3U);
  reload();
  EXPECT_EQ(session_->scene()->tools.size(), 3U);
}

TEST_F(SessionToolsTest, ADamagedRowLosesOnlyItsShape) {
  carve();
  const std::uint64_t expected = hash();
  change_journal("UPDATE tools SET json='{}' WHERE tool=3");
  reload();
  EXPECT_EQ(hash(), expected);
  EXPECT_EQ(session_->scene()->tools.size(), 3U);
  EXPECT_EQ(make(kWide).id, 5U) << "motions use the number of the lost one";
}

}  // namespace
}  // namespace kerf::session_tools_test
