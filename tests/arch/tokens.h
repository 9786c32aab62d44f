// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tests/arch/source.h"

namespace kerf::arch {

/// Words that must not stand where they stand: unfinished work anywhere, libm in the kernel (equal
/// commands must give equal bytes on any CPU), fast-math in a build file, allocation and locks in
/// the servo loop.
std::vector<Violation> check_tokens(const Source& source);

}  // namespace kerf::arch
