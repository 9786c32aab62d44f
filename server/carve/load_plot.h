// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/carve/load_curve.h"

namespace kerf {

/// Plots force and removal rate over the time of a program as SVG, with the line of the program at
/// each maximum.
std::string load_svg(const LoadCurve& loads, const Program& program);

}  // namespace kerf
