// SPDX-License-Identifier: Apache-2.0
#include "server/merge/journal_merge.h"

#include "tests/server/merge/copies.h"

namespace kerf::journal_merge_test {
namespace {

constexpr const char* kTriDexel = R"({
  "name": "Test block",
  "stock": {"shape": "box", "min_mm": [-20, -20, -20], "max_mm": [20, 20, 0]},
  "accuracy": {"rays": "tri-dexel", "pitch_mm": 1, "tolerance_mm": 0.02, "motion": "tight"},
  "tools": [{"id": 1, "shape": "ball", "diameter_mm": 10, "length_mm": 60}],
  "machine": {"kinematics": "tool-vector"}})";

/// Random work and exchange of several people, and then everybody merges everybody in two orders.
void meet(Copies& copies) {
  copies.work(0, 6);
  for (int n = 0; n < 3; ++n) copies.share(0);
  for (int round = 0; round < 12; ++round) {
    const std::size_t who = copies.pick(copies.size());
    if (copies.pick(3) == 0) {
      copies.merge(who, copies.pick(copies.size()));
      copies.check(who);
    } else {
      copies.work(who, 1 + static_cast<int>(copies.pick(5)));
    }
  }
  const std::size_t people = copies.size();
  for (std::size_t n = 0; n < people; ++n) copies.share(n);
  for (std::size_t n = 1; n < people; ++n) {
    copies.merge(0, n);
    copies.merge(people, 2 * people - n);
  }
  EXPECT_EQ(copies.check(0), copies.check(people));
  EXPECT_EQ(copies.merge(people - 1, 0), copies.check(people));
}

TEST(JournalMerge, AnyOrderOfAnyExchangeGivesOneBlock) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(seed);
    Copies copies(seed, seed % 3 == 0 ? kTriDexel : kScene);
    meet(copies);
    if (HasFailure()) return;
  }
}

TEST(JournalMerge, MergingAgainTakesNothing) {
  Copies copies(3);
  copies.work(0, 4);
  const std::size_t other = copies.share(0);
  copies.work(0, 5);
  copies.work(other, 5);
  copies.merge(0, other);
  EXPECT_TRUE(strokes_to_merge(copies.file(0), copies.file(other)).value().empty());
  test::TemporaryFolder folder;
  const auto again = merge_journals(copies.file(0), copies.file(other), folder / "again.kerf");
  ASSERT_TRUE(again);
  EXPECT_EQ(again->motions, 0u);
  EXPECT_EQ(again->people, 0u);
  EXPECT_EQ(again->tools, 0u);
  EXPECT_EQ(again->undone + again->redone, 0u);
}

TEST(JournalMerge, ABranchMergesBack) {
  Copies copies(5);
  copies.work(0, 5);
  const std::size_t branch = copies.branch(0);
  copies.work(0, 5);
  copies.work(branch, 5);
  copies.merge(0, branch);
  copies.check(0);
  EXPECT_EQ(copies.merge(branch, 0), copies.check(0));
}

TEST(JournalMerge, CopiesOfAFileWithoutOriginsHaveTheirRecordsInCommon) {
  Copies copies(6);
  copies.work(0, 6);
  copies.forget_origins(0);
  const std::size_t other = copies.share(0), branch = copies.branch(0);
  copies.work(0, 4);
  copies.work(other, 4);
  copies.work(branch, 4);
  copies.merge(0, other);
  copies.merge(0, branch);
  copies.check(0);
  copies.merge(branch, other);
  EXPECT_EQ(copies.merge(branch, 0), copies.check(0));
}

TEST(JournalMerge, TakesChosenStrokesOnly) {
  Copies copies(7);
  copies.work(0, 3);
  const std::size_t other = copies.share(0);
  copies.work(other, 8);
  const auto missing = strokes_to_merge(copies.file(0), copies.file(other)).value();
  ASSERT_GE(missing.size(), 3u);
  EXPECT_EQ(missing.front().author, "hand 1");
  test::TemporaryFolder folder;
  const StrokeSet chosen{missing[1].id};
  const auto merged =
      merge_journals(copies.file(0), copies.file(other), folder / "one.kerf", chosen);
  ASSERT_TRUE(merged) << merged.error().reason;
  ASSERT_EQ(merged->strokes.size(), 1u);
  EXPECT_EQ(merged->strokes[0].id, missing[1].id);
  EXPECT_EQ(merged->motions, missing[1].motions);
  const auto rest = strokes_to_merge(folder / "one.kerf", copies.file(other)).value();
  ASSERT_EQ(rest.size(), missing.size() - 1);
  EXPECT_EQ(rest[0].id, missing[0].id);
  EXPECT_EQ(rest[1].id, missing[2].id);
}

/// Both files end in the middle of a stroke that one of them continues and then undoes.
TEST(JournalMerge, AStrokeOfWhichACopyHasTheFirstHalfIsUndoneWhole) {
  test::TemporaryFolder folder;
  const auto ours = folder / "ours.kerf", theirs = folder / "theirs.kerf";
  const Scene scene = parse_scene(kScene, SceneSource{}).value();
  auto writer = JournalWriter::create(theirs, {"block", kScene, "", 1, {}}).value();
  writer.append(0, DefineTool{1, scene.tools.at(1).tool}).value();
  writer.append(JournalParticipant{1, "Ada", "#112233", "agent"});
  const auto cut = [&](double from_mm, bool begins) {
    const ToolPose at{{from_mm, 0, -3}, {0, 0, 1}}, to{{from_mm + 5, 0, -3}, {0, 0, 1}};
    return writer.append(1, MoveTool{1, at, to, 0.01, false}, {.begins_stroke = begins}).value();
  };
  const StrokeId stroke = cut(-10, true);
  ASSERT_TRUE(writer.flush());
  const std::uint64_t untouched = Sculpture::create(scene.settings)->state_hash();
  ASSERT_TRUE(copy_journal(theirs, ours));
  cut(-5, false);
  ASSERT_TRUE(writer.flush());
  const auto both = merge_journals(ours, theirs, folder / "both.kerf");
  ASSERT_TRUE(both) << both.error().reason;
  EXPECT_EQ(both->motions, 1u);
  EXPECT_EQ(both->hash, carve_without(theirs, {})->hash);
  writer.append(1, StrokeChange{stroke, true}).value();
  ASSERT_TRUE(writer.finish());
  const auto undone = merge_journals(folder / "both.kerf", theirs, folder / "undone.kerf");
  ASSERT_TRUE(undone) << undone.error().reason;
  EXPECT_EQ(undone->undone, 2u);
  EXPECT_EQ(undone->hash, untouched);
}

class JournalMergeErrors : public testing::Test {
 protected:
  JournalMergeErrors() {
    copies.work(0, 3);
    other = copies.share(0);
    copies.work(other, 3);
  }
  MergeErrorCode error(const std::filesystem::path& theirs,
                       const std::optional<StrokeSet>& chosen = {}) {
    const auto merged = merge_journals(copies.file(0), theirs, folder / "out.kerf", chosen);
    EXPECT_FALSE(merged);
    EXPECT_FALSE(merged.error().reason.empty());
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 0);
    return merged.error().code;
  }
  void execute(const std::string& sql) {
    auto database = SqlDatabase::open(copies.file(other), SqlMode::kWrite);
    ASSERT_TRUE(database && database->execute(sql));
  }

  Copies copies{8};
  std::size_t other = 0;
  test::TemporaryFolder folder;
};

TEST_F(JournalMergeErrors, AnotherScene) {
  Copies others(9, kTriDexel);
  EXPECT_EQ(error(others.file(0)), MergeErrorCode::kDifferentBlock);
}

TEST_F(JournalMergeErrors, AnotherKernel) {
  execute("INSERT INTO kernel_versions VALUES(1,1)");
  EXPECT_EQ(error(copies.file(other)), MergeErrorCode::kDifferentKernel);
}

TEST_F(JournalMergeErrors, AStrokeThatIsNotThere) {
  EXPECT_EQ(error(copies.file(other), StrokeSet{9999}), MergeErrorCode::kUnknownStroke);
}

TEST_F(JournalMergeErrors, ADamagedFile) {
  execute("UPDATE batches SET bytes=zeroblob(length(bytes))");
  EXPECT_EQ(error(copies.file(other)), MergeErrorCode::kJournal);
}

TEST_F(JournalMergeErrors, ADamagedOrigin) {
  execute("UPDATE origins SET crc=crc+1 WHERE first=(SELECT max(first) FROM origins)");
  EXPECT_EQ(error(copies.file(other)), MergeErrorCode::kJournal);
}

TEST_F(JournalMergeErrors, ASalvagedFile) {
  execute(
      "CREATE TABLE files(name TEXT PRIMARY KEY, bytes BLOB NOT NULL, crc INTEGER NOT NULL);"
      "INSERT INTO files VALUES('kerf-base-2',x'',0)");
  EXPECT_EQ(error(copies.file(other)), MergeErrorCode::kJournal);
}

TEST_F(JournalMergeErrors, AnOutputThatExists) {
  const auto merged = merge_journals(copies.file(0), copies.file(other), copies.file(other));
  ASSERT_FALSE(merged);
  EXPECT_EQ(merged.error().code, MergeErrorCode::kJournal);
  EXPECT_EQ(strokes_to_merge(copies.file(other), copies.file(0)).value().size(), 0u);
}

}  // namespace
}  // namespace kerf::journal_merge_test
