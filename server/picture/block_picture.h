// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "kernel/dexel/dexel_snapshot.h"
#include "server/picture/picture_rod.h"

namespace kerf {

inline constexpr int kPictureSideMin = 16;
inline constexpr int kPictureSideMax = 1280;

/// A picture in sRGB with straight alpha: rows from the top, 4 bytes a pixel.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

/// Views of a block: direction of the eye from the middle of the block.
inline constexpr Vec3 kFromFrontLeft{-0.45, -1, 1.42};
inline constexpr Vec3 kFromBackRight{0.45, 1, 1.42};
inline constexpr Vec3 kFromAbove{0, -0.02, 1};

/// Appearance of a block.
struct PictureStyle {
  int width = 0, height = 0;  ///< in [kPictureSideMin, kPictureSideMax]
  Vec3 towards_eye = kFromFrontLeft;
  /// Returns the linear color, 0 to 1, of the surface at a point, or nullopt for wood.
  std::function<std::optional<Vec3>(Vec3 point_mm)> paint = {};
  /// Drawn in front of, in, behind and outside the block. They cast no shadows.
  std::vector<PictureRod> rods = {};
};

/// Renders a block from its field along Z, on a transparent background, in limewood with darker
/// original surfaces, with one light that casts shadows. Each pixel is the mean of four rays. Equal
/// snapshots give equal bytes on any CPU. `progress` receives the completed share, 0 to 1. Returns
/// nullopt if `stop` was requested.
std::optional<Picture> render_block(const DexelSnapshot& field, const PictureStyle& style,
                                    const std::function<void(double)>& progress,
                                    const std::stop_token& stop);

}  // namespace kerf
