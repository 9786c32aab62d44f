// SPDX-License-Identifier: Apache-2.0
#include "server/merge/journal_merge.h"

#include "server/formats/pose_grid.h"
#include "server/formats/scene.h"
#include "server/merge/journal_side.h"
#include "server/session/journal_carve.h"
#include "server/session/made_tool.h"
#include "server/store/journal_branch.h"
#include "server/store/journal_writer.h"
#include "tests/server/session_fixture.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::journal_merge_test {
namespace {

/// A stroke of the world. Its first pose identifies it in every journal.
struct Cut {
  Tool tool;
  std::vector<ToolPose> poses;
};

/// An undo or a redo: which changes its author knew.
struct Mark {
  std::size_t cut = 0;
  bool undone = false;
  std::set<std::size_t> known;
};

/// One person's file: the cuts and marks that it has.
struct Copy {
  std::filesystem::path file;
  std::set<std::size_t> cuts, marks;
};

/// People who carve copies of one block, each a file, and merge each other's.
class Copies {
 public:
  explicit Copies(unsigned seed, const char* scene = kScene) : random_(seed), scene_(scene) {
    const Scene parsed = parse_scene(scene_, SceneSource{}).value();
    settings_ = parsed.settings;
    Copy first = next_file();
    {
      auto writer = JournalWriter::create(first.file, {"block", scene_, "", 1, {}}).value();
      for (const auto& [id, tool] : parsed.tools) {
        writer.append(0, DefineTool{id, tool.tool}).value();
      }
      EXPECT_TRUE(writer.finish());
    }
    copies_.push_back(first);
  }

  std::size_t pick(std::size_t count) { return random_() % count; }
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 4294967296.0);
  }

  /// Gives a copy of a file to one person more.
  std::size_t share(std::size_t from) {
    Copy copy = copies_[from];
    copy.file = next_file().file;
    EXPECT_TRUE(copy_journal(copies_[from].file, copy.file));
    copies_.push_back(copy);
    return copies_.size() - 1;
  }

  /// Gives a branch of a file to one person more.
  std::size_t branch(std::size_t from) {
    Copy copy = copies_[from];
    copy.file = next_file().file;
    const std::uint64_t last = read_side(copies_[from].file).value().last();
    EXPECT_TRUE(branch_journal(copies_[from].file, copy.file, "branch", {"block", last, 1, 0}));
    copies_.push_back(copy);
    return copies_.size() - 1;
  }
  /// Leaves a file as one that was written before files had origins.
  void forget_origins(std::size_t who) {
    auto database = SqlDatabase::open(copies_[who].file, SqlMode::kWrite);
    EXPECT_TRUE(database && database->execute("DROP TABLE origins"));
  }

  /// Carves strokes, undoes and redoes, and makes tools in one opening of a file.
  void work(std::size_t who, int steps) {
    Copy& copy = copies_[who];
    const JournalSide side = read_side(copy.file).value();
    auto writer = JournalWriter::open(copy.file, side.last()).value();
    const ParticipantId hand = static_cast<ParticipantId>(side.participants.size() + 1);
    writer.append(JournalParticipant{hand, "hand " + std::to_string(who), "#112233", "agent"});
    std::map<ToolId, Tool> known = side.tools;
    for (int step = 0; step < steps; ++step) {
      const std::size_t kind = pick(8);
      if (kind == 0) {
        const ToolId id = known.rbegin()->first + 1;
        const Tool made =
            make_tool(BallShape{.diameter_mm = 2.0 + static_cast<double>(pick(6)), .length_mm = 40})
                .value();
        writer.append(0, DefineTool{id, made}).value();
        known.emplace(id, made);
      } else if (kind <= 2 && !copy.cuts.empty()) {
        mark(copy, writer, hand);
      } else {
        cut(copy, writer, hand, known);
      }
    }
    EXPECT_TRUE(writer.finish());
  }

  /// Replaces a person's file with the merge of it and another's. Returns the hash.
  std::uint64_t merge(std::size_t into, std::size_t from) {
    const Copy out = next_file();
    const auto merged = merge_journals(copies_[into].file, copies_[from].file, out.file);
    EXPECT_TRUE(merged) << merged.error().reason;
    copies_[into].file = out.file;
    copies_[into].cuts.insert(copies_[from].cuts.begin(), copies_[from].cuts.end());
    copies_[into].marks.insert(copies_[from].marks.begin(), copies_[from].marks.end());
    return merged ? merged->hash : 0;
  }

  /// Checks a file against the world: it has exactly its cuts, and of the changes of each the one
  /// that no other follows. Returns its hash.
  std::uint64_t check(std::size_t who) {
    const Copy& copy = copies_[who];
    const auto states = states_in(copy.file);
    Sculpture block = Sculpture::create(settings_).value();
    EXPECT_EQ(states.size(), copy.cuts.size());
    for (const std::size_t cut : copy.cuts) {
      const auto state = states.find(cut);
      if (state == states.end()) ADD_FAILURE() << "stroke " << cut << " is lost";
      const bool undone = state != states.end() && state->second;
      EXPECT_TRUE(possible(copy, cut).contains(undone)) << "stroke " << cut;
      if (!undone) carve(block, cuts_[cut]);
    }
    const auto carved = carve_without(copy.file, {});
    EXPECT_TRUE(carved) << carved.error();
    EXPECT_EQ(carved->hash, block.state_hash());
    return carved->hash;
  }

  const std::filesystem::path& file(std::size_t who) const { return copies_[who].file; }
  std::size_t size() const { return copies_.size(); }

 private:
  Copy next_file() {
    return {.file = folder_ / (std::to_string(++files_) + ".kerf"), .cuts = {}, .marks = {}};
  }
  ToolPose pose() {
    return admit_pose({{uniform(-22, 22), uniform(-22, 22), uniform(-9, 2)},
                       normalized({uniform(-0.5, 0.5), uniform(-0.5, 0.5), 1})});
  }
  void cut(Copy& copy, JournalWriter& writer, ParticipantId hand,
           const std::map<ToolId, Tool>& known) {
    const auto tool = std::next(known.begin(), static_cast<std::ptrdiff_t>(pick(known.size())));
    Cut made{tool->second, {pose()}};
    for (std::size_t n = 1 + pick(3); n > 0; --n) {
      const ToolPose to = pose();
      const MoveTool motion{tool->first, made.poses.back(), to, 0.01, false};
      writer.append(hand, motion, {.begins_stroke = made.poses.size() == 1}).value();
      made.poses.push_back(to);
    }
    copy.cuts.insert(cuts_.size());
    cuts_.push_back(std::move(made));
  }
  void mark(Copy& copy, JournalWriter& writer, ParticipantId hand) {
    const std::size_t cut =
        *std::next(copy.cuts.begin(), static_cast<std::ptrdiff_t>(pick(copy.cuts.size())));
    EXPECT_TRUE(writer.flush());
    StrokeId stroke = 0;
    for (const auto& [id, first] : first_poses(copy.file)) {
      if (first == cuts_[cut].poses.front()) stroke = id;
    }
    const bool undone = pick(3) > 0;
    writer.append(hand, StrokeChange{stroke, undone}).value();
    copy.marks.insert(marks_.size());
    marks_.push_back({cut, undone, copy.marks});
  }
  /// The strokes of a file and their first poses.
  static std::map<StrokeId, ToolPose> first_poses(const std::filesystem::path& file) {
    auto reader = JournalReader::open(file).value();
    std::map<StrokeId, ToolPose> firsts;
    for (auto record = reader.next(); record && *record; record = reader.next()) {
      const auto* move = std::get_if<MoveTool>(&(*record)->command);
      if (move != nullptr) firsts.emplace((*record)->stroke, move->from);
    }
    return firsts;
  }
  /// The cuts of a file, and whether each is undone there.
  std::map<std::size_t, bool> states_in(const std::filesystem::path& file) const {
    const JournalSide side = read_side(file).value();
    const StrokeSet undone = side.strokes.at(side.last()).without;
    std::map<std::size_t, bool> states;
    for (const auto& [stroke, first] : first_poses(file)) {
      const auto found =
          std::ranges::find_if(cuts_, [&](const Cut& cut) { return cut.poses.front() == first; });
      EXPECT_NE(found, cuts_.end());
      const auto index = static_cast<std::size_t>(found - cuts_.begin());
      EXPECT_TRUE(states.emplace(index, undone.contains(stroke)).second) << "twice: " << index;
    }
    return states;
  }
  /// The states of a cut that its changes allow: that of a change that no other one knew.
  std::set<bool> possible(const Copy& copy, std::size_t cut) const {
    std::set<std::size_t> of_cut, followed;
    for (const std::size_t mark : copy.marks) {
      if (marks_[mark].cut == cut) of_cut.insert(mark);
    }
    for (const std::size_t mark : of_cut) {
      for (const std::size_t known : marks_[mark].known) {
        if (known != mark) followed.insert(known);
      }
    }
    std::set<bool> states;
    for (const std::size_t mark : of_cut) {
      if (!followed.contains(mark)) states.insert(marks_[mark].undone);
    }
    return states.empty() ? std::set{false} : states;
  }
  static void carve(Sculpture& block, const Cut& cut) {
    ASSERT_TRUE(block.apply(DefineTool{1, cut.tool}));
    for (std::size_t n = 1; n < cut.poses.size(); ++n) {
      ASSERT_TRUE(block.apply(MoveTool{1, cut.poses[n - 1], cut.poses[n], 0.01, false}));
    }
  }

  std::mt19937 random_;
  std::string scene_;
  SculptureSettings settings_;
  test::TemporaryFolder folder_;
  int files_ = 0;
  std::vector<Cut> cuts_;
  std::vector<Mark> marks_;
  std::vector<Copy> copies_;
};

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
