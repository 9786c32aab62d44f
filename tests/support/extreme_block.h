// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <string>

#include "kernel/sculpture.h"

namespace kerf::test {

/// Settings of a block whose sides differ widely from each other and from its pitch: from flatter
/// than a ten-thousandth of a pitch to `pitches_max` pitches long, up to 1000 km from the origin,
/// as a box, a cylinder or a mesh. Equal seeds give equal blocks.
class ExtremeBlock {
 public:
  ExtremeBlock(unsigned seed, Rays rays, double pitches_max = 300)
      : random_(seed), pitches_max_(pitches_max) {
    settings.rays = rays;
    settings.pitch_mm = std::array{1e-4, 0.02, 0.3, 7.0, 1000.0}[random_() % 5];
    settings.tolerance_mm = std::max(1e-6, 1e-3 * std::min(settings.pitch_mm, 100.0));
    const Vec3 size{side(), side(), side()};
    const double far = std::array{0.0, 10.0, 9e5}[random_() % 3];
    const Vec3 low{far, -far, far / 3};
    switch (random_() % 3) {
      case 0:
        settings.stock = CylinderStock{low.x, low.y, size.x / 2, low.z, low.z + size.z};
        break;
      case 1:
        settings.stock_mesh = std::make_shared<const TriangleMesh>(tetrahedron(low, size));
        settings.stock = BoxStock{low, low + size};
        break;
      default:
        settings.stock = BoxStock{low, low + size};
    }
  }

  /// Builds the block and cuts it `cuts` times with a ball of about its size.
  Sculpture make(int cuts) {
    Sculpture sculpture = *Sculpture::create(settings);
    const BoxStock box = stock_bounds(sculpture.settings().stock);
    const Vec3 size = box.max_mm - box.min_mm;
    for (int n = 0; n < cuts; ++n) {
      const double diameter = std::clamp(uniform(0.05, 2) * size.z, 1e-3, 1000.0);
      const auto id = static_cast<ToolId>(n);
      const auto ball = make_tool(BallShape{diameter, 3 * diameter});
      if (!ball || !sculpture.apply(DefineTool{id, *ball})) continue;
      const auto in_box = [&] {
        return box.min_mm +
               Vec3{size.x * uniform(0, 1), size.y * uniform(0, 1), size.z * uniform(0, 1)};
      };
      const Vec3 from = in_box(), to = from + (in_box() - from) * uniform(0, 0.2);
      const Vec3 axis{uniform(-1, 1), uniform(-1, 1), uniform(0.1, 1)};
      // A motion that is too long for the tool is rejected.
      (void)sculpture.apply(
          MoveTool{id, {from, normalized(axis)}, {to, normalized(axis)}, 1, false});
    }
    return sculpture;
  }

  SculptureSettings settings;

 private:
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 4294967296.0);
  }
  /// Returns the length of a side: fractions of a pitch, a few pitches, or many.
  double side() {
    const double pitches = std::array{uniform(1e-4, 0.01),
                                      uniform(0.1, 0.49),
                                      0.5,
                                      uniform(0.5, 3),
                                      uniform(0.1, 0.2) * pitches_max_,
                                      uniform(0.7, 1) * pitches_max_}[random_() % 6];
    return std::clamp(pitches * settings.pitch_mm, 2e-4, 9e4);
  }
  static TriangleMesh tetrahedron(Vec3 low, Vec3 size) {
    return {{low, low + Vec3{size.x, 0, 0}, low + Vec3{0, size.y, 0}, low + size},
            {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
  }

  std::mt19937 random_;
  double pitches_max_;
};

}  // namespace kerf::test
