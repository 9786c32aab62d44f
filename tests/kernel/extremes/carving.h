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
/// Returns one tool of every cutting shape, with diameters of about 10 mm times `scale`.
std::vector<NamedTool> every_tool(double scale = 1);

/// A block that is carved and verified: it records each motion, and compares the remaining stock
/// with the true sweeps of the motions.
class Carving {
 public:
  Carving(SculptureSettings settings, const Tool& tool);

  /// Moves the tool. A rejected motion fails the test and changes nothing.
  MotionResult move(const ToolPose& from, const ToolPose& to);
  /// Adds a sweep to the reference, for motions that were applied directly to the sculpture.
  void judge_by(const TrueSweep& sweep) { sweeps_.push_back(sweep); }
  Sculpture& sculpture() { return sculpture_; }
  const Tool& tool() const { return tool_; }

  /// Returns the greatest error (mm): the distance of a dexel's end from the true swept surface,
  /// the depth of remaining material inside the sweep, or of removed material outside it. Samples
  /// `columns` columns at random points of the tool's surface along each motion, and their
  /// neighbors. Errors above `interest_mm` may be reported as that value.
  double error_mm(int columns, double interest_mm, unsigned seed = 1);
  /// Expects no error above the scene's tolerance plus the rounding of depths.
  void expect_within_tolerance(const std::string& what, int columns = 40, unsigned seed = 1);
  /// Number of dexel ends measured so far, and the RMS of their distances from the true surface.
  long ends_judged() const { return ends_judged_; }
  double rms_mm() const;
  /// Returns how far outside the true sweeps material was removed, at most, in the columns judged
  /// so far, including half a depth quantum of rounding.
  double overcut_mm() const { return overcut_mm_; }
  /// Description of the greatest error so far.
  const std::string& worst_place() const { return worst_place_; }
  /// Allowed error in addition to the tolerance: half a depth quantum, and double rounding at these
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
  double squares_mm2_ = 0, overcut_mm_ = 0;
};

/// Factor by which tests with random motions increase their number: the environment variable
/// KERF_EFFORT, 1 if it is not set.
int effort();

/// Returns a pose whose axis leans by `lean_rad` from +Z towards `azimuth_rad`.
ToolPose leaning(Vec3 tip, double lean_rad, double azimuth_rad = 0);
/// Returns the axis turned by `turn_rad` about the direction `about` (made perpendicular to the
/// axis).
Vec3 turned(Vec3 axis, Vec3 about, double turn_rad);

/// Returns a box stock of the given size with the center of its top at `top_center`.
SculptureSettings block(double width_mm, double height_mm, double pitch_mm, double tolerance_mm,
                        Vec3 top_center = {});

/// Returns the solid elements of a column as text, for messages and comparisons.
std::vector<Dexel> column_of(const DexelSnapshot& snapshot, std::int32_t i, std::int32_t j);

/// Fails unless every column's elements are sorted, disjoint, not empty and within the block.
void expect_sound(const DexelSnapshot& snapshot, const std::string& what);

}  // namespace kerf::test
