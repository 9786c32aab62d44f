// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <unordered_set>
#include <vector>

#include "kernel/sculpture.h"
#include "tests/kernel/extremes/carving.h"
#include "tests/kernel/extremes/true_sweep.h"
#include "tests/support/mesh_check.h"

namespace kerf::test {

/// Random numbers that are equal on every machine for equal seeds.
class SeededDraws {
 public:
  explicit SeededDraws(unsigned seed) : random_(seed) {}
  double in(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 4294967296.0);
  }
  /// Returns a vector whose components are within `size` of zero.
  Vec3 vec(double size) {
    const double x = in(-size, size), y = in(-size, size), z = in(-size, size);
    return {x, y, z};
  }

 private:
  std::mt19937 random_;
};

/// A block that is carved by both the kernel and the true sweeps.
struct TrueCarving {
  Vec3 size_mm;
  Sculpture sculpture;
  std::vector<TrueSweep> sweeps;

  TrueCarving(Vec3 size, double pitch_mm, Rays rays)
      : size_mm(size), sculpture(*Sculpture::create(settings(size, pitch_mm, rays))) {}

  static SculptureSettings settings(Vec3 size_mm, double pitch_mm, Rays rays) {
    return SculptureSettings{.stock = BoxStock{{0, 0, 0}, size_mm},
                             .rays = rays,
                             .pitch_mm = pitch_mm,
                             .tolerance_mm = 1e-3 * pitch_mm};
  }

  /// Moves a tool. A motion that the kernel rejects, one that turns beyond 170 degrees, carves
  /// neither.
  void move(ToolId id, const Tool& tool, const ToolPose& from, const ToolPose& to) {
    if (sculpture.apply(MoveTool{id, from, to, 1, false})) sweeps.emplace_back(tool, from, to);
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

/// A block that every tool has carved in five axes. Equal seeds and widths give the same solid at
/// any pitch.
struct RandomCarving : TrueCarving {
  RandomCarving(unsigned seed, double width_mm, double pitch_mm, Rays rays)
      : TrueCarving(Vec3{1.01, 0.97, 0.7} * width_mm, pitch_mm, rays) {
    SeededDraws draws(seed);
    const double w = width_mm;
    const auto tools = every_tool(w / 25);
    constexpr unsigned kMotions = 8;
    for (unsigned n = 0; n < kMotions; ++n) {
      const std::size_t t = (seed + 7 * n) % tools.size();
      const auto id = static_cast<ToolId>(n);
      EXPECT_TRUE(sculpture.apply(DefineTool{id, tools[t].tool}));
      const double x = draws.in(0, w), y = draws.in(0, w);
      const Vec3 tip{x, y, draws.in(0.2 * w, 0.75 * w)};
      const ToolPose from{tip, normalized(draws.vec(1) + Vec3{0, 0, 1})};
      const Vec3 travel = draws.vec(0.3 * w);
      move(id, tools[t].tool, from, {tip + travel, normalized(from.axis + draws.vec(0.3))});
    }
  }
};

/// A small block that one tool has carved in five axes. Equal seeds give equal jobs. The motions
/// follow each other, as those of a program, and every fourth begins elsewhere.
struct ToolJob : TrueCarving {
  static constexpr double kPitchMm = 0.25;
  /// The diameter of every_tool() is about 10 mm times this.
  static constexpr double kToolScale = 0.25;

  ToolJob(unsigned seed, const Tool& tool, Rays rays)
      : TrueCarving({6.06, 5.82, 4.2}, kPitchMm, rays) {
    SeededDraws draws(seed);
    sculpture.apply(DefineTool{1, tool}).value();
    ToolPose at;
    for (unsigned n = 0; n < 8; ++n) {
      if (n % 4 == 0) {
        const double x = draws.in(0, size_mm.x), y = draws.in(0, size_mm.y);
        at = {{x, y, draws.in(1, 4.2)}, normalized(draws.vec(0.8) + Vec3{0, 0, 1})};
      }
      const Vec3 travel = draws.vec(1.5);
      const ToolPose to{at.tip_mm + travel, normalized(at.axis + draws.vec(0.3))};
      move(1, tool, at, to);
      at = to;
    }
  }

  /// Returns the errors in pitches, up to 1, of every `every`-th of the different vertices of
  /// meshes.
  std::vector<double> errors(const std::vector<TileMesh>& meshes, std::size_t every = 1) const {
    std::unordered_set<std::array<float, 3>, PositionHash> seen;
    std::vector<double> all;
    for (const TileMesh& mesh : meshes) {
      for (const auto& p : mesh.positions_mm) {
        if (seen.insert(p).second && seen.size() % every == 0)
          all.push_back(error_mm({double(p[0]), double(p[1]), double(p[2])}) / kPitchMm);
      }
    }
    return all;
  }
};

}  // namespace kerf::test
