// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>
#include <string>
#include <vector>

#include "kernel/sculpture.h"
#include "tests/kernel/extremes/true_sweep.h"

namespace kerf::test {

struct NamedTool {
  std::string name;
  Tool tool;
};
/// Every shape that cuts, about 10 mm across times `scale`.
std::vector<NamedTool> every_tool(double scale = 1);

/// A block that is carved and judged: it remembers each motion and compares what is left with what
/// the true motions sweep.
class Carving {
 public:
  Carving(SculptureSettings settings, const Tool& tool);

  /// Moves the tool; a rejection fails the test and changes nothing.
  MotionResult move(const ToolPose& from, const ToolPose& to);
  /// Judges what was carved by this sweep too: for motions that were applied to the sculpture
  /// itself.
  void judge_by(const TrueSweep& sweep) { sweeps_.push_back(sweep); }
  Sculpture& sculpture() { return sculpture_; }
  const Tool& tool() const { return tool_; }

  /// Greatest distance (mm) by which a dexel's end lies off the true swept surface, material was
  /// left deeper inside the sweep, or was removed farther outside it; over `columns` columns at
  /// random places of the tool's surface along each motion, and their neighbours. `interest_mm` is
  /// what is worth measuring: anything larger may be reported as that.
  double error_mm(int columns, double interest_mm, unsigned seed = 1);
  /// The same as a test: no error above the scene's tolerance and the rounding of depths.
  void expect_within_tolerance(const std::string& what, int columns = 40, unsigned seed = 1);
  /// Of the ends of dexels that all judgements so far have looked at: how many, and the root of the
  /// mean square of their distance from the true surface.
  long ends_judged() const { return ends_judged_; }
  double rms_mm() const;
  /// Where the greatest error was seen.
  const std::string& worst_place() const { return worst_place_; }
  /// What an end may err beside the tolerance: half a depth quantum, and double rounding at these
  /// coordinates.
  double rounding_mm() const;

 private:
  double field_error(const DexelSnapshot& snapshot, int columns, double interest_mm, unsigned seed);
  double column_error(const DexelSnapshot& snapshot, std::int32_t i, std::int32_t j,
                      double interest_mm);
  std::string motions_text() const;
  void note(double error, double& worst, Vec3 at, const char* what);
  double outside(Vec3 point, double interest_mm) const;

  Sculpture sculpture_;
  Tool tool_;
  std::vector<TrueSweep> sweeps_;
  std::string worst_place_;
  long ends_judged_ = 0;
  double squares_mm2_ = 0;
};

/// How much harder than in the test suite to look: the environment's KERF_EFFORT, 1 if it is not
/// set. Tests with random motions take that many times as many.
int effort();

/// A pose whose axis leans by `lean_rad` from +Z towards `azimuth_rad`.
ToolPose leaning(Vec3 tip, double lean_rad, double azimuth_rad = 0);
/// The axis turned by `turn_rad` about the direction `about` (made perpendicular to the axis).
Vec3 turned(Vec3 axis, Vec3 about, double turn_rad);

/// A box stock of the given size with its top's centre at `top_center`.
SculptureSettings block(double width_mm, double height_mm, double pitch_mm, double tolerance_mm,
                        Vec3 top_center = {});

/// Everything that is solid in a column, as text: for messages and comparisons.
std::vector<Dexel> column_of(const DexelSnapshot& snapshot, std::int32_t i, std::int32_t j);

/// Fails unless every column's elements are sorted, disjoint, not empty and within the block.
void expect_sound(const DexelSnapshot& snapshot, const std::string& what);

}  // namespace kerf::test
