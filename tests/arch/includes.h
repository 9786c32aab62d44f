// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <vector>

#include "tests/arch/source.h"

namespace kerf::arch {

/// Returns the includes that break the dependency rules of the README: of a module or library that
/// this file may not use, of a system header in the kernel or wire, or of a path that does not
/// start at the repository root. `paths` holds every path of the tree.
std::vector<Violation> check_includes(const Source& source, const std::set<std::string>& paths);

}  // namespace kerf::arch
