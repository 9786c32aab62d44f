// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tests/arch/source.h"

namespace kerf::arch {

/// Files and folders as a whole: every .cpp is built by a CMakeLists.txt, every folder with sources
/// is described by a README (its own or one above it, below the root), every room with headers has
/// a test that includes one of them, and the top level holds only what the README lists.
std::vector<Violation> check_rooms(const std::vector<Source>& tree);

}  // namespace kerf::arch
