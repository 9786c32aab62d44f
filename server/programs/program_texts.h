// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "server/http/api_call.h"

namespace kerf::net {

/// Maximum number of points that are kept of a program's path.
inline constexpr std::size_t kPathPointsMax = 20'000;

/// Returns the text of the program in the path of a request, as it was uploaded.
ApiResponse program_source(const ApiCall& call);
/// Returns the path of the program's tip, for drawing.
ApiResponse program_path(const ApiCall& call);

}  // namespace kerf::net
