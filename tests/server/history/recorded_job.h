// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/sculpture.h"
#include "server/history/stroke_table.h"
#include "server/store/journal_writer.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::test {

/// Several hands that carve a block at the same time, in strokes and with four tools, of which one
/// is redefined in between. Recorded in a journal on disk.
class RecordedJob {
 public:
  RecordedJob(const SculptureSettings& settings, unsigned seed)
      : settings_(settings), random_(seed) {
    auto writer = JournalWriter::create(file(), {"job", "{}", "", 1, {}});
    EXPECT_TRUE(writer.has_value());
    writer_.emplace(*std::move(writer));
    define(1, BallShape{.diameter_mm = 6, .length_mm = 30});
    define(2, FlatShape{.diameter_mm = 5, .length_mm = 30});
    define(3, BullNoseShape{7, 2, 30});
    define(4, ConeEndShape{.diameter_mm = 6, .tip_angle_deg = 90, .length_mm = 30});
  }

  std::filesystem::path file() const { return folder_ / "job.kerf"; }
  const SculptureSettings& settings() const { return settings_; }
  const std::vector<JournalRecord>& records() const { return records_; }
  const std::vector<StrokeId>& strokes() const { return strokes_; }
  std::mt19937& random() { return random_; }
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 4294967296.0);
  }

  /// Adds `motions` motions of three hands, of `step_mm` each, and commits them.
  void carve(int motions, double step_mm = 4) {
    for (int n = 0; n < motions; ++n) move(random_() % hands_.size(), step_mm);
    EXPECT_TRUE(writer_->flush());
  }
  /// Undoes or redoes a stroke. A stroke in progress ends.
  void change(StrokeId stroke, bool undone) {
    append(0, StrokeChange{stroke, undone}, false);
    for (Hand& hand : hands_) hand.left = 0;
    EXPECT_TRUE(writer_->flush());
  }
  /// Redefines a tool.
  void redefine() {
    define(4, BallShape{.diameter_mm = 3, .length_mm = 30});
    EXPECT_TRUE(writer_->flush());
  }

  /// Returns the block as if only this set of motions had ever happened.
  Sculpture block(const MotionSet& set) const {
    Sculpture sculpture = Sculpture::create(settings_).value();
    for (const JournalRecord& record : records_) {
      const auto command = kernel_command(record.command);
      const bool is_move = std::holds_alternative<MoveTool>(record.command);
      if (!command || record.sequence > set.last) continue;
      if (is_move && set.without.contains(record.stroke)) continue;
      sculpture.apply(*command).value();
    }
    return sculpture;
  }
  /// Returns a random set of motions.
  MotionSet some() {
    MotionSet set;
    if (random_() % 3 == 0) set.last = 1 + random_() % records_.size();
    set.last = std::min<std::uint64_t>(set.last, records_.size());
    const unsigned share = 2 + static_cast<unsigned>(random_() % 20);
    for (const StrokeId id : strokes_) {
      if (random_() % share == 0) set.without.insert(id);
    }
    return set;
  }

 private:
  struct Hand {
    ToolPose at;
    ToolId tool = 1;
    StrokeId stroke = 0;
    int left = 0;  ///< motions of its stroke
  };

  void append(ParticipantId participant, RecordedCommand command, bool begins_stroke) {
    const auto sequence = writer_->append(participant, command, {0, begins_stroke});
    ASSERT_TRUE(sequence.has_value());
    JournalRecord record{*sequence, participant, std::move(command)};
    if (participant != 0) {
      Hand& hand = hands_[participant - 1];
      if (begins_stroke) hand.stroke = *sequence;
      record.stroke = hand.stroke;
    }
    if (begins_stroke) strokes_.push_back(*sequence);
    records_.push_back(std::move(record));
  }
  void define(ToolId id, const ToolShape& shape) {
    append(0, DefineTool{id, *make_tool(shape)}, false);
  }
  void move(std::size_t n, double step_mm) {
    Hand& hand = hands_[n];
    const bool begins = hand.left == 0;
    if (begins) {
      const auto& box = std::get<BoxStock>(settings_.stock);
      hand.at = {{uniform(box.min_mm.x, box.max_mm.x), uniform(box.min_mm.y, box.max_mm.y),
                  uniform(box.max_mm.z - 4, box.max_mm.z + 0.5)},
                 normalized({uniform(-0.4, 0.4), uniform(-0.4, 0.4), 1})};
      hand.tool = static_cast<ToolId>(1 + random_() % 4);
      hand.left = 1 + static_cast<int>(random_() % 12);
    }
    ToolPose to = hand.at;
    to.tip_mm = to.tip_mm + Vec3{uniform(-step_mm, step_mm), uniform(-step_mm, step_mm),
                                 uniform(-step_mm / 8, step_mm / 8)};
    if (random_() % 2 == 0) to.axis = normalized(to.axis + Vec3{uniform(-0.1, 0.1), 0, 0});
    --hand.left;
    append(static_cast<ParticipantId>(n + 1), MoveTool{hand.tool, hand.at, to, 0.01, false},
           begins);
    hand.at = to;
  }

  SculptureSettings settings_;
  TemporaryFolder folder_;
  std::mt19937 random_;
  std::optional<JournalWriter> writer_;
  std::vector<Hand> hands_{3};
  std::vector<JournalRecord> records_;
  std::vector<StrokeId> strokes_;
};

/// A box of 40 x 30 x 10 mm.
inline SculptureSettings job_settings(Rays rays, double pitch_mm) {
  return SculptureSettings{
      .stock = BoxStock{{0, 0, -10}, {40, 30, 0}}, .rays = rays, .pitch_mm = pitch_mm};
}

}  // namespace kerf::test
