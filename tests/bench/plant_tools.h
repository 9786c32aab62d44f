// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kerf::agent {

/// Rests random tools in random hands on faces (random_face_rest) with the seeds from `first_seed`
/// on. Prints, for each tool and in total, how many move faster than 2 and 5 mm/s rms at rest, the
/// greatest energy returned and trips, then the worst runs with their plants. Returns whether no
/// run moves faster than 2 mm/s and none returns more than the tank.
bool tools_table(int runs, std::uint32_t first_seed);

}  // namespace kerf::agent
