// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <optional>
#include <string>

#include "kernel/sculpture.h"

namespace kerf {

/// Writes the header line of a forces file:
/// t_s,x,y,z,i,j,k,fx_n,fy_n,fz_n,tx_nmm,ty_nmm,tz_nmm,removed_mm3,imprint_mm3
/// With `device`, followed by felt_fx_n,felt_fy_n,felt_fz_n,felt_tx_nmm,felt_ty_nmm,felt_tz_nmm.
void write_forces_header(std::ostream& out, const std::optional<WrenchMaximum>& device = {});
/// Writes the row of one motion: the time at its end in s, its end pose (tip in mm, axis), the
/// wrench on the user (cutting and collision; torque about the pivot), the volume removed, and the
/// imprint's part of it. With `device`, followed by the wrench as a device with this maximum
/// outputs it, reduced by share_within as in kerf-agent.
void write_forces_row(std::ostream& out, double time_s, const ToolPose& pose,
                      const MotionResult& result, const std::optional<WrenchMaximum>& device = {});

}  // namespace kerf
