// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace kerf {

/// Returns evidence that a G-code program is for a lathe, such as "line 4 has G50 S", or "". A
/// lathe has no Y, and uses one of its codes: G50 S, G96, a cycle G70 to G76 with P and Q, U or W
/// together with X, Z or each other.
std::string sign_of_turning(std::string_view text);

}  // namespace kerf
