// SPDX-License-Identifier: Apache-2.0
// Exported programs of cuts without a movement.
#include <algorithm>
#include <atomic>
#include <future>
#include <set>
#include <vector>

#include "tests/server/export_fixture.h"

namespace kerf::export_test {
namespace {

/// A scene with an obstacle, so that a tool at rest is recorded. Tool 3 is larger than tool 1.
class ExportOfRests : public SessionExport {
 protected:
  void SetUp() override {
    SessionExport::SetUp();
    std::string scene = kScene;
    scene.replace(scene.find("\"tools\": ["), 10,
                  R"("tools": [{"id": 3, "shape": "ball", "diameter_mm": 16, "length_mm": 60}, )");
    scene.insert(scene.rfind('}'), R"(, "obstacles": [{"shape": "box", "min_mm": [-20, -20, 50],
      "max_mm": [20, 20, 55], "stiffness_n_per_mm": 2}])");
    create(scene);
    ada_ = join("Ada");
  }
  /// Rests the tool for some cutting samples.
  void rest(Vec3 tip, std::uint32_t tool, int samples = 3) {
    for (int n = 0; n < samples; ++n) {
      wire::MotionSample sample = next(ada_, tip, true);
      sample.tool_id = tool;
      EXPECT_TRUE(session_->move(ada_, {&sample, 1}).rejections.empty());
    }
  }
  /// Returns the durations of the dwells of an exported program, s.
  std::vector<double> dwells(ProgramFormat format) {
    const auto program = parse_program(format == ProgramFormat::kApt ? "x.apt" : "x.ngc",
                                       exported(format), *session_->scene());
    std::vector<double> dwells;
    for (const ProgramMotion& motion : program.value().motions) {
      if (motion.from == motion.to) dwells.push_back(motion.duration_s);
    }
    return dwells;
  }

  ParticipantId ada_ = 0;
};

TEST_F(ExportOfRests, RestingToolLeavesItsImprint) {
  move(ada_, {0, 0, -3}, false);
  rest({0, 0, -3}, 1);
  move(ada_, {0, 0, 10}, false);
  EXPECT_GT(session_->info().removed_mm3, 20);
  expect_equal_exports();
}

TEST_F(ExportOfRests, LargerToolInASlotLeavesItsImprint) {
  stroke(ada_, {-10, 0, -3}, {10, 0, -3});
  move(ada_, {0, 0, -3}, false);
  const double before_mm3 = session_->info().removed_mm3;
  rest({0, 0, -3}, 3);
  EXPECT_GT(session_->info().removed_mm3, before_mm3 + 20);
  expect_equal_exports();
}

TEST_F(ExportOfRests, RestKeepsItsImprintWhenTheStrokeBeforeIsUndone) {
  const StrokeId slot = stroke(ada_, {-10, 0, -3}, {0, 0, -3});
  move(ada_, {0, 0, -3}, false);
  rest({0, 0, -3}, 1);
  undo({slot});
  EXPECT_GT(session_->info().removed_mm3, 20);
  expect_equal_exports();
}

TEST_F(ExportOfRests, RestsThatCutNothingAreNotWritten) {
  stroke(ada_, {-10, 0, -3}, {10, 0, -3});
  move(ada_, {10, 0, -3}, false);
  rest({10, 0, -3}, 1, 50);
  for (int n = 0; n < 10; ++n) move(ada_, {10, 0.5 * n, -3});
  rest({10, 4.5, -3}, 1, 50);
  expect_equal_exports();
  EXPECT_TRUE(dwells(ProgramFormat::kGcode).empty());
}

TEST_F(ExportOfRests, DwellsOfAProgramAreKept) {
  const std::string text =
      "G21 G90 G94 T1 M6\nG0 X0 Y0 Z5\nG1 Z-3 F600\nG4 P0.25\nG0 Z5\nG4 P0.5\nX5\nM2\n";
  const auto program = parse_program("drill.ngc", text, *session_->scene());
  ASSERT_TRUE(program);
  ASSERT_TRUE(session_->programs().start(*program, {ProgramPace::kFast}));
  executor_->run();
  EXPECT_EQ(dwells(ProgramFormat::kGcode), (std::vector{0.25, 0.5}));
  EXPECT_EQ(dwells(ProgramFormat::kApt), (std::vector{0.25, 0.5}));
  expect_equal_exports();
}

TEST_F(SessionExport, ConcurrentUndoLeavesAConsistentExport) {
  create();
  const ParticipantId ada = join("Ada");
  std::atomic<bool> ends = false;
  // No two strokes exist at the same time: each one is drawn after the previous one was undone.
  auto exports = std::async(std::launch::async, [&] {
    std::size_t most = 0;
    while (!ends) {
      std::ostringstream text;
      EXPECT_TRUE(export_program(session_->journal_file(), {}, text));
      const auto program = parse_program("export.ngc", text.str(), *session_->scene());
      std::set<double> strokes;
      for (const ProgramMotion& motion : program.value().motions)
        strokes.insert(motion.to.tip_mm.y);
      most = std::max(most, strokes.size());
    }
    return most;
  });
  for (int n = 0; n < 120; ++n) {
    const double y = n % 30 - 15;
    const StrokeId id = stroke(ada, {-10, y, -1}, {10, y, -1});
    EXPECT_TRUE(session_->flush());
    undo({id});
    EXPECT_TRUE(session_->flush());
  }
  ends = true;
  EXPECT_EQ(exports.get(), 1U);
}

}  // namespace
}  // namespace kerf::export_test
