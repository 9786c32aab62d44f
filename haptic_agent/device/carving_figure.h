// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "haptic_agent/device/pose_script.h"

namespace kerf::agent {

/// The box around a block of stock.
struct StockBox {
  Vec3 min_mm{};
  Vec3 max_mm{};
};

/// A path that suits any block: from above, rosettes into its top with an axis that leans outwards,
/// each one turned against the last and a little deeper, and up again. Its size follows the
/// block's, it stays within 0.4 of the block's smaller side from the middle, and no deeper than a
/// quarter of its height. `variant` turns it, so that several hands at one block draw different
/// figures.
PoseScript make_carving_figure(const StockBox& stock, std::uint32_t variant);

}  // namespace kerf::agent
