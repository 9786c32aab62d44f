// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "tests/arch/source.h"

namespace kerf::arch {

/// Checks files and folders as a whole: every .cpp is built by a CMakeLists.txt, every folder with
/// sources is described by a README (its own or one above it, below the root), every module with
/// headers has a test that includes one of them, links between READMEs resolve, and the top level
/// holds only the folders of the design.
std::vector<Violation> check_modules(const std::vector<Source>& tree);

}  // namespace kerf::arch
