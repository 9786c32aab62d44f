// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kerf {

/// The effect of a change on a table; part of the format of changes.
enum class RowChange : std::uint8_t {
  kPut = 1,     ///< followed by all columns of a row, which replaces the one with its key
  kRemove = 2,  ///< followed by the key of a row
  kClear = 3    ///< removes all rows; creates the table if it is missing
};

}  // namespace kerf
