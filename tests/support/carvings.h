// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>

#include "kernel/sculpture.h"

namespace kerf::test {

inline Sculpture make_sculpture(StockShape stock, double pitch_mm) {
  return std::move(Sculpture::create({.stock = stock, .pitch_mm = pitch_mm}).value());
}

/// A block carved by random moves of a ball, a flat, a taper and a cone-ended tool whose axes lean
/// up to 90 degrees, so that it gets pockets, undercuts, tunnels and loose pieces. Equal seeds give
/// equal blocks.
class RandomCarver {
 public:
  RandomCarver(Sculpture& sculpture, Vec3 low_mm, Vec3 high_mm, unsigned seed)
      : sculpture_(sculpture), low_(low_mm), high_(high_mm), random_(seed) {
    define(1, BallShape{.diameter_mm = 4, .length_mm = 30});
    define(2, FlatShape{.diameter_mm = 3, .length_mm = 30});
    define(3, TaperShape{.diameter_mm = 1, .half_angle_deg = 15, .length_mm = 20});
    define(4, ConeEndShape{.diameter_mm = 5, .tip_angle_deg = 90, .length_mm = 30});
  }

  /// Makes one move and returns the tiles that it changed.
  std::vector<TileIndex> cut() {
    const Vec3 from = point();
    const Vec3 to = from + Vec3{uniform(-8, 8), uniform(-8, 8), uniform(-4, 4)};
    const Vec3 axis = lean();
    const Vec3 turned = normalized(axis + Vec3{uniform(-0.3, 0.3), uniform(-0.3, 0.3), 0});
    const auto tool = static_cast<ToolId>(1 + random_() % 4);
    const auto result = sculpture_.apply(MoveTool{tool, {from, axis}, {to, turned}, 1, false});
    return result ? result->changed_tiles : std::vector<TileIndex>{};
  }

  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 4294967296.0);
  }

 private:
  void define(ToolId id, const ToolShape& shape) {
    if (!sculpture_.apply(DefineTool{id, make_tool(shape).value()})) std::abort();
  }
  Vec3 point() {
    return {uniform(low_.x, high_.x), uniform(low_.y, high_.y), uniform(low_.z, high_.z)};
  }
  Vec3 lean() { return normalized({uniform(-1, 1), uniform(-1, 1), uniform(0, 1.5)}); }

  Sculpture& sculpture_;
  Vec3 low_, high_;
  std::mt19937 random_;
};

}  // namespace kerf::test
