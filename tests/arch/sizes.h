// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "tests/arch/source.h"

namespace kerf::arch {

inline constexpr std::size_t kColumnsMax = 100;
inline constexpr std::size_t kFileLinesMax = 400;  ///< the aim is 300: one idea a file
inline constexpr std::size_t kFunctionLinesMax = 70;

/// Returns lines and functions that are too long (C++; functions are found by their braces), and
/// files that are too long (C++ and TypeScript). Raw literals may make a line long.
std::vector<Violation> check_sizes(const Source& source);

}  // namespace kerf::arch
