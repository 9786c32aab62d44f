// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <random>
#include <unordered_set>
#include <vector>

#include "kernel/sculpture.h"
#include "tests/kernel/extremes/carving.h"
#include "tests/kernel/extremes/true_sweep.h"
#include "tests/support/mesh_check.h"

namespace kerf::test {

/// A small block that one tool has carved in five axes, and the true sweeps. Equal seeds give equal
/// jobs on every machine. The motions follow each other, as those of a program, and every fourth
/// begins elsewhere.
struct ToolJob {
  static constexpr double kPitchMm = 0.25;

  Vec3 size_mm{6.06, 5.82, 4.2};
  Sculpture sculpture;
  std::vector<TrueSweep> sweeps;

  ToolJob(unsigned seed, const Tool& tool, Rays rays)
      : sculpture(*Sculpture::create(settings(size_mm, rays))) {
    std::mt19937 random(seed);
    const auto in = [&](double low, double high) {
      return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
    };
    const auto vec = [&](double size) {
      const double x = in(-size, size), y = in(-size, size), z = in(-size, size);
      return Vec3{x, y, z};
    };
    sculpture.apply(DefineTool{1, tool}).value();
    ToolPose at;
    for (unsigned n = 0; n < 8; ++n) {
      if (n % 4 == 0) {
        const double x = in(0, size_mm.x), y = in(0, size_mm.y);
        at = {{x, y, in(1, 4.2)}, normalized(vec(0.8) + Vec3{0, 0, 1})};
      }
      const Vec3 travel = vec(1.5);
      const ToolPose to{at.tip_mm + travel, normalized(at.axis + vec(0.3))};
      if (sculpture.apply(MoveTool{1, at, to, 1, false})) sweeps.emplace_back(tool, at, to);
      at = to;
    }
  }

  /// The diameter of every_tool() is about 10 mm times this.
  static constexpr double kToolScale = 0.25;

  static SculptureSettings settings(Vec3 size_mm, Rays rays) {
    SculptureSettings s;
    s.stock = BoxStock{{0, 0, 0}, size_mm};
    s.pitch_mm = kPitchMm;
    s.tolerance_mm = 1e-3 * kPitchMm;
    s.rays = rays;
    return s;
  }

  /// Returns the distance of a point from the surface of the true solid, in pitches, up to 1.
  double error(Vec3 p) const {
    double outside =
        std::max({-p.x, p.x - size_mm.x, -p.y, p.y - size_mm.y, -p.z, p.z - size_mm.z});
    for (const TrueSweep& sweep : sweeps) {
      outside = std::max(outside, -sweep.outside(p, kPitchMm));
    }
    return std::abs(outside) / kPitchMm;
  }

  /// Returns the errors of every `every`-th of the different vertices of meshes.
  std::vector<double> errors(const std::vector<TileMesh>& meshes, std::size_t every = 1) const {
    std::unordered_set<std::array<float, 3>, PositionHash> seen;
    std::vector<double> all;
    for (const TileMesh& mesh : meshes) {
      for (const auto& p : mesh.positions_mm) {
        if (seen.insert(p).second && seen.size() % every == 0)
          all.push_back(error({double(p[0]), double(p[1]), double(p[2])}));
      }
    }
    return all;
  }
};

}  // namespace kerf::test
