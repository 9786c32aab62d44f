// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "kernel/math/vec3.h"
#include "server/store/sqlite.h"

namespace kerf {

/// A text at a place of the block's surface.
struct Pin {
  std::uint32_t number = 0;  ///< from 1; unique in its session
  std::string text;
  Vec3 at_mm, normal;           ///< the normal is the unit vector out of the material
  std::uint64_t record = 0;     ///< the last one when it was set
  std::int64_t created_ms = 0;  ///< when it was set; ms since 1970, UTC
  std::string author;           ///< name of who set it; empty: unknown
  std::string person;           ///< its grant; empty: none
};

/// A pin that is set or removed.
struct PinChange {
  Pin pin;
  bool is_removed = false;
};

inline constexpr std::size_t kPinTextBytesMax = 200;
/// Pins of a session: each viewer gets all of them when one changes.
inline constexpr std::size_t kPinsMax = 100;

/// Creates the table unless it is there.
SqlResult<void> create_pin_table(SqlDatabase& database);
SqlResult<void> store_pin(SqlDatabase& database, const PinChange& change);
/// The pins that were set up to a record, by number; a row that is damaged is left out. None if
/// there is no table.
SqlResult<std::vector<Pin>> read_pins(SqlDatabase& database, std::uint64_t last);

}  // namespace kerf
