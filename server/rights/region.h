// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "kernel/math/vec3.h"

namespace kerf {

/// A reserved part of the block: an axis-aligned box in which only one participant, or one person,
/// and the owners may cut.
struct Region {
  std::uint32_t id = 0;  ///< from 1, unique in its session
  Vec3 min_mm = {}, max_mm = {};
  std::uint32_t participant = 0;  ///< may cut; 0: owners only
  std::string person = {};        ///< the grant of that participant, if it has one of its own
  friend bool operator==(const Region&, const Region&) = default;
};

}  // namespace kerf
