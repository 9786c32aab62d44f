// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "haptic_agent/device/pose_script.h"

namespace kerf::agent {

/// The bounding box of a block of stock.
struct StockBox {
  Vec3 min_mm{};
  Vec3 max_mm{};
};

/// Returns a path scaled to the block: an approach from above, rosettes in the block's top with the
/// axis tilted outward, each rotated against the previous one and slightly deeper, and a
/// retraction. The path stays within 0.4 of the block's shorter side from its center, and no deeper
/// than a quarter of its height. `variant` rotates it, so that several simulated hands carve
/// different figures.
PoseScript make_carving_figure(const StockBox& stock, std::uint32_t variant);

}  // namespace kerf::agent
