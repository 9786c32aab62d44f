// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "kernel/sculpture.h"
#include "tests/kernel/extremes/carving.h"
#include "tests/kernel/extremes/true_sweep.h"

namespace kerf::test {

/// A block that every tool has carved in five axes, and the true sweeps. Equal seeds and widths
/// give the same solid at any pitch.
struct RandomCarving {
  Vec3 size_mm;
  Sculpture sculpture;
  std::vector<TrueSweep> sweeps;

  RandomCarving(unsigned seed, double width_mm, double pitch_mm, Rays rays)
      : size_mm(Vec3{1.01, 0.97, 0.7} * width_mm),
        sculpture(*Sculpture::create(settings(size_mm, pitch_mm, rays))) {
    std::mt19937 random(seed);
    const auto in = [&](double low, double high) {
      return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
    };
    const auto vec = [&](double size) {
      const double x = in(-size, size), y = in(-size, size), z = in(-size, size);
      return Vec3{x, y, z};
    };
    const double w = width_mm;
    const auto tools = every_tool(w / 25);
    constexpr unsigned kMotions = 8;
    for (unsigned n = 0; n < kMotions; ++n) {
      const std::size_t t = (seed + 7 * n) % tools.size();
      const auto id = static_cast<ToolId>(n);
      EXPECT_TRUE(sculpture.apply(DefineTool{id, tools[t].tool}));
      const double x = in(0, w), y = in(0, w);
      const Vec3 tip{x, y, in(0.2 * w, 0.75 * w)};
      const ToolPose from{tip, normalized(vec(1) + Vec3{0, 0, 1})};
      const Vec3 travel = vec(0.3 * w);
      const ToolPose to{tip + travel, normalized(from.axis + vec(0.3))};
      // A turn beyond 170 degrees is rejected.
      if (sculpture.apply(MoveTool{id, from, to, 1, false})) {
        sweeps.emplace_back(tools[t].tool, from, to);
      }
    }
  }

  static SculptureSettings settings(Vec3 size_mm, double pitch_mm, Rays rays) {
    SculptureSettings s;
    s.stock = BoxStock{{0, 0, 0}, size_mm};
    s.pitch_mm = pitch_mm;
    s.tolerance_mm = 1e-3 * pitch_mm;
    s.rays = rays;
    return s;
  }

  /// Returns the distance (mm) of a point from the surface of the true solid, up to one pitch.
  double error_mm(Vec3 p) const {
    double outside =
        std::max({-p.x, p.x - size_mm.x, -p.y, p.y - size_mm.y, -p.z, p.z - size_mm.z});
    for (const TrueSweep& sweep : sweeps) {
      outside = std::max(outside, -sweep.outside(p, sculpture.settings().pitch_mm));
    }
    return std::abs(outside);
  }
};

}  // namespace kerf::test
