// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "kernel/math/vec3.h"

namespace kerf {

/// The size of the stock in a comment of a program.
struct StatedStock {
  Vec3 size_mm;
  std::size_t line = 0;  ///< line of the comment, from 1
};

/// Returns the first size of a stock, material, block or blank in the comments of a program, such
/// as "(STOCK SIZE X100. Y50. Z20.)", "(stock/block, 100, 50, 20, 0, 0, 0)", "(Material 100 x 50 x
/// 20 mm)" or the line "( X= 100 Y= 50 Z= 20)" after "( Material Size)"; in APT also of INSERT and
/// PPRINT: "INSERT/Stock Size X100. Y60. Z12.". Lengths without a unit are in the program's unit,
/// `unit_mm`.
std::optional<StatedStock> stated_stock(std::string_view program, double unit_mm);

}  // namespace kerf
