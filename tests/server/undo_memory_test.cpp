// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/server/undo_fixture.h"
#include "tests/support/failing_memory.h"

namespace kerf::undo_memory_test {
namespace {

constexpr const char* kLargeScene = R"({
  "name": "Plate of one square meter",
  "stock": {"shape": "box", "min_mm": [0, 0, -20], "max_mm": [1000, 1000, 0]},
  "accuracy": {"rays": "dexel", "pitch_mm": 0.5, "tolerance_mm": 0.01, "motion": "tight"},
  "tools": [{"id": 1, "shape": "flat", "diameter_mm": 60, "length_mm": 60}],
  "machine": {"kinematics": "tool-vector"}})";

class UndoMemory : public SessionUndo {
 protected:
  void SetUp() override {
    limits_.speed_mm_per_s = 1e9;  // a meter in each motion
    restart();
  }
};

/// The strokes reach all tiles of the block, so all of it is carved again.
TEST_F(UndoMemory, IsAtMostATenthOfTheBlock) {
  const std::uint64_t without = test::allocated_bytes();
  create(kLargeScene);
  const ParticipantId ada = join("Ada");
  std::vector<StrokeId> strokes;
  for (int y = 25; y < 1000; y += 50) {
    strokes.push_back(stroke(ada, {-50, double(y), -2}, {1050, double(y), -3}, 1));
  }
  executor_->run();
  const std::uint64_t carved = hash();
  const std::uint64_t block = test::allocated_bytes() - without;
  ASSERT_GT(block, std::uint64_t{50} << 20U);
  const auto most_during = [&](const auto& change) {
    const test::PeakMemory memory;
    change();
    return memory.bytes() - without;
  };
  const std::uint64_t undoing = most_during([&] { undo(strokes); });
  EXPECT_LE(undoing, block + block / 10) << "block: " << block << " bytes";
  const std::uint64_t redoing = most_during([&] { redo(strokes); });
  EXPECT_LE(redoing, block + block / 10) << "block: " << block << " bytes";
  EXPECT_EQ(hash(), carved);
  RecordProperty("block", std::to_string(block));
  RecordProperty("undoing", std::to_string(undoing));
  RecordProperty("redoing", std::to_string(redoing));
}

}  // namespace
}  // namespace kerf::undo_memory_test
