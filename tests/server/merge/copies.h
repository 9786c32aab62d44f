// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/formats/pose_grid.h"
#include "server/formats/scene.h"
#include "server/merge/journal_merge.h"
#include "server/merge/journal_side.h"
#include "server/session/journal_carve.h"
#include "server/store/journal_branch.h"
#include "server/store/journal_writer.h"
#include "tests/server/session_fixture.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf {

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

}  // namespace kerf
