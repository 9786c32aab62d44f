// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "kernel/math/vec3.h"
#include "server/store/list_table.h"

namespace kerf {

/// A text at a point of the block's surface.
struct Pin {
  std::uint32_t number = 0;  ///< from 1; unique in its session
  std::string text;
  Vec3 at_mm, normal;           ///< the normal is the unit vector out of the material
  std::uint64_t record = 0;     ///< the last record when it was set
  std::int64_t created_ms = 0;  ///< when it was set; ms since 1970, UTC
  std::string author;           ///< name of the person who set it; empty if unknown
  std::string person;           ///< grant of that person; empty if none
};

inline constexpr std::size_t kPinTextBytesMax = 200;
/// Maximum number of pins in a session: each viewer gets all of them when one changes.
inline constexpr std::size_t kPinsMax = 100;

/// Converts a pin to its row in the table `pins` of the journal, and back. Coordinates are stored
/// as the bits of their doubles.
ListRow to_row(const Pin& pin);
Pin pin_of(const ListRow& row);

/// Returns a pin as a JSON object, for the HTTP interface and for viewers.
std::string pin_json(const Pin& pin);

}  // namespace kerf
