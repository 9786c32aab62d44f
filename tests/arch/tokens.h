// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tests/arch/source.h"

namespace kerf::arch {

/// Returns the banned tokens of a source: unfinished work anywhere, libm in the kernel (equal
/// commands must give equal bytes on any CPU), epsilons outside kernel/math/tolerance.h, fast-math
/// in a build file, clocks and random numbers outside server/platform, allocation and locks in the
/// servo loop.
std::vector<Violation> check_tokens(const Source& source);

}  // namespace kerf::arch
