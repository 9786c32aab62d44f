// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kernel/dexel/dexel.h"

namespace kerf {

// Set operations on the elements of one column, which are ordered upwards and do not touch.

/// Stores `whole` minus `taken` in `rest`.
void subtract(std::span<const Dexel> whole, std::span<const Dexel> taken, std::vector<Dexel>& rest);

/// Stores the intersection of `a` and `b` in `common`.
void intersect(std::span<const Dexel> a, std::span<const Dexel> b, std::vector<Dexel>& common);

}  // namespace kerf
