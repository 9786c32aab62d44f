// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>

#include "kernel/sculpture.h"

namespace kerf {

/// The head line of a forces file: t_s,x,y,z,i,j,k,fx_n,…,removed_mm3.
void write_forces_header(std::ostream& out);
/// One motion: the time at its end (s), its end pose, the wrench on the hand (cutting and
/// collision, about the pivot) and the volume that it removed.
void write_forces_row(std::ostream& out, double time_s, const ToolPose& pose, const Wrench& wrench,
                      double removed_mm3);

}  // namespace kerf
