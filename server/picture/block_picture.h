// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "kernel/dexel/dexel_snapshot.h"

namespace kerf {

inline constexpr int kPictureSideMin = 16;
inline constexpr int kPictureSideMax = 1280;

/// A picture in sRGB with straight alpha: rows from the top, 4 bytes a pixel.
struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

/// Renders a block from its field along Z, on a transparent background, in limewood with darker
/// original surfaces, with one light that casts shadows. Each pixel is the mean of four rays. Equal
/// snapshots give equal bytes on any CPU. Width and height must be in [kPictureSideMin,
/// kPictureSideMax]. `progress` receives the completed share, 0 to 1. Nothing if `stop` was
/// requested meanwhile.
std::optional<Picture> render_block(const DexelSnapshot& field, int width, int height,
                                    const std::function<void(double)>& progress,
                                    const std::stop_token& stop);

}  // namespace kerf
