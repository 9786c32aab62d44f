// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>

#include "kernel/sculpture.h"

namespace kerf {

/// Writes the header line of a forces file:
/// t_s,x,y,z,i,j,k,fx_n,fy_n,fz_n,tx_nmm,ty_nmm,tz_nmm,removed_mm3,imprint_mm3
void write_forces_header(std::ostream& out);
/// Writes the row of one motion: the time at its end in s, its end pose (tip in mm, axis), the
/// wrench on the user (cutting and collision; torque about the pivot), the volume removed, and the
/// part of it that is imprint.
void write_forces_row(std::ostream& out, double time_s, const ToolPose& pose,
                      const MotionResult& result);

}  // namespace kerf
