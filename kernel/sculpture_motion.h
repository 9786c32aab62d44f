// SPDX-License-Identifier: Apache-2.0
#pragma once

// Shared by the parts of Sculpture that apply motions.

#include "kernel/dexel/dexel_grid.h"
#include "kernel/math/ray_axis.h"
#include "kernel/math/rotation.h"
#include "kernel/sculpture_command.h"
#include "kernel/sweep/column_block.h"
#include "kernel/sweep/tool_motion.h"
#include "kernel/tool/tool.h"

namespace kerf {

/// The volume that a motion removed from one field, its imprint part, and the number of elements
/// that it shortened, which is the area of the cut seen along the rays, in squares of the pitch.
struct RemovedVolume {
  double mm3, imprint_mm3, elements;
};

/// How earlier motions relate to the pose where a motion starts.
struct MotionStart {
  bool is_cut;     ///< the tool's last motion ended there, so a sweep may skip regions behind it
  bool continues;  ///< a motion of the tool ended there, so no removed element is imprint
};

/// Returns the motion of a command, with unit axes.
inline ToolMotion motion_of(const MoveTool& command, const Tool& tool) {
  return make_motion({command.from.tip_mm, normalized(command.from.axis)},
                     {command.to.tip_mm, normalized(command.to.axis)}, tool.length_mm);
}

/// Returns the motion in the frame of the field along `axis`.
inline ToolMotion in_frame(RayAxis axis, ToolMotion motion) {
  for (ToolPose* pose : {&motion.from, &motion.to}) {
    *pose = {to_frame(axis, pose->tip_mm), to_frame(axis, pose->axis)};
  }
  return motion;
}

/// Returns the bounds of the rays of a field.
inline SweepBounds ray_bounds(const DexelGrid& grid) {
  return {{grid.x_mm(0), grid.y_mm(0), grid.origin_mm.z},
          {grid.x_mm(grid.columns_x - 1), grid.y_mm(grid.columns_y - 1),
           grid.z_mm(grid.height_quanta)}};
}

}  // namespace kerf
