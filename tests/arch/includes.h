// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <vector>

#include "tests/arch/source.h"

namespace kerf::arch {

/// What breaks the dependency rule of the README: includes of another room, of a library outside
/// its rooms, of the system in a leaf, or not written from the repository's root. `paths` holds
/// every path of the tree.
std::vector<Violation> check_includes(const Source& source, const std::set<std::string>& paths);

}  // namespace kerf::arch
