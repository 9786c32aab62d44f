// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kerf {

/// What a change does to a table; part of the format of changes.
enum class RowChange : std::uint8_t {
  kPut = 1,     ///< all columns of a row follow, which replaces the one of its key
  kRemove = 2,  ///< the key of a row follows
  kClear = 3    ///< all rows go; the table is created if it is missing
};

}  // namespace kerf
