// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "haptic_agent/demo/ammonite.h"
#include "haptic_agent/demo/stroke.h"

namespace kerf::demo {

/// The tools of demo.json.
inline constexpr BallTool kCoarse{1, 6, 60}, kShell{2, 2.5, 60}, kFloor{3, 3, 60},
    kFine{4, 1.5, 60};
/// Longest time between two lifts of a hand. Undo works on strokes, and a tool around which stock
/// has come back cuts again only after leaving it.
inline constexpr double kStrokeSeconds = 8;
/// Height of a tool between two strokes.
inline constexpr double kRetractMm = 12;

/// The strokes of the demo's two agents, which carve at the same time. Both rough out the dish
/// along the two arms of a spiral. Then the first finishes the outer whorl with strokes across it,
/// from the mouth inward, while the second finishes the dish and then the inner whorls along the
/// coil.
struct Carving {
  std::vector<Stroke> first, second;
};
Carving carve(const Ammonite& ammonite);

}  // namespace kerf::demo
