// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernel/force/collision.h"
#include "kernel/tool/tool.h"
#include "server/formats/program.h"

namespace kerf {

/// Returns the greatest force of obstacles on the tool, N, at poses at most 0.5 mm of travel apart
/// along a motion, but at no more than `places_max`, its ends included.
double greatest_push_n(const Obstacles& obstacles, const Tool& tool, const ProgramMotion& motion,
                       double pivot_mm, int places_max);

}  // namespace kerf
