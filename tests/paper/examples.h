// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kernel/sculpture.h"
#include "server/formats/program.h"

namespace kerf::paper {

/// One of the paper's examples, recreated: a stock, a tool (number 1) and the poses that it passes.
struct Example {
  SculptureSettings settings;
  ToolShape shape;
  std::vector<ToolPose> path;
  double speed_mm_per_s = 20;
};

/// Fig. 15: a bird in relief, a height field that a ball of 1.2 mm follows in rows.
Example bird();
/// Fig. 16: a ball on a curved path of changing depth, in steps of 0.25 mm.
Example curve();
/// Fig. 17: a Chinese character (forever) by a cone that leans like a brush, in five strokes.
Example brush();
/// Fig. 18: a front of a drawer in five axes: a wavy surface, and two spirals cut into it, with the
/// tool along the normal. The last `*spirals` poses belong to the spirals.
Example furniture(std::size_t* spirals = nullptr);
/// The wavy surface of that front at a position of its stock, and its unit normal by central
/// differences.
Vec3 front_point(double x_mm, double y_mm);
Vec3 front_normal(double x_mm, double y_mm);

/// Returns the height of the bird above the ground of its relief, mm, at a position of its stock.
double bird_height(double x_mm, double y_mm);

/// A motion of an example and its result.
struct Step {
  ToolPose from, to;
  MotionResult result;
};
struct Carved {
  Sculpture block;
  std::vector<Step> steps;
};
/// Carves an example.
Carved carve(const Example& example);
/// Returns an untouched block with tool 1 defined.
Sculpture block_of(const SculptureSettings& settings, const ToolShape& shape);

}  // namespace kerf::paper
