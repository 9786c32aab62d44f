// SPDX-License-Identifier: Apache-2.0
#include "tests/paper/examples.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kerf::paper {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

/// A point of a stroke: position and width of the line, mm.
struct Dab {
  double x, y, width;
};

Dab between(const std::vector<Dab>& dabs, std::size_t n, double s) {
  const auto at = [&](long k) {
    return dabs[std::size_t(std::clamp(k, 0L, long(dabs.size()) - 1))];
  };
  const Dab a = at(long(n) - 1), b = at(long(n)), c = at(long(n) + 1), d = at(long(n) + 2);
  // Catmull and Rom, 1974.
  const auto spline = [s](double p, double q, double r, double t) {
    return q + 0.5 * s * (r - p + s * (2 * p - 5 * q + 4 * r - t + s * (3 * (q - r) + t - p)));
  };
  return {spline(a.x, b.x, c.x, d.x), spline(a.y, b.y, c.y, d.y),
          std::max(0.1, spline(a.width, b.width, c.width, d.width))};
}

/// Appends a stroke, between a pose above its begin and one above its end.
void append_between(const std::vector<ToolPose>& stroke, ToolPose (*above)(ToolPose),
                    std::vector<ToolPose>& path) {
  path.push_back(above(stroke.front()));
  path.insert(path.end(), stroke.begin(), stroke.end());
  path.push_back(above(stroke.back()));
}

/// Appends a stroke of a cone of 90 degrees, which leans away from the direction of the line, like
/// a brush.
void append_stroke(const std::vector<Dab>& dabs, std::vector<ToolPose>& path) {
  std::vector<ToolPose> stroke;
  for (std::size_t n = 0; n + 1 < dabs.size(); ++n) {
    const int steps =
        1 + int(std::hypot(dabs[n + 1].x - dabs[n].x, dabs[n + 1].y - dabs[n].y) / 0.4);
    for (int k = 0; k < steps; ++k) {
      const Dab at = between(dabs, n, double(k) / steps);
      const Dab next = between(dabs, n, (k + 0.5) / steps);
      const Vec3 ahead = normalized({next.x - at.x, next.y - at.y, 0});
      const Vec3 axis = normalized(Vec3{0.2, -0.15, 1} - ahead * 0.2);
      stroke.push_back({{at.x, at.y, -at.width / 2}, axis});
    }
  }
  constexpr double kAboveStockMm = 3;
  append_between(
      stroke,
      [](ToolPose pose) {
        return ToolPose{{pose.tip_mm.x, pose.tip_mm.y, kAboveStockMm}, pose.axis};
      },
      path);
}

ToolPose pose_on_front(double x, double y, double depth_mm) {
  const Vec3 normal = front_normal(x, y);
  return {front_point(x, y) - normal * depth_mm, normal};
}

}  // namespace

Example curve() {
  Example one{{}, BallShape{6, 30}, {}, 20};
  one.settings.stock = BoxStock{{0, 0, -8}, {68, 40, 0}};
  one.settings.pitch_mm = 0.1;
  one.settings.force.law = ForceLaw::kDexelRemovalRate;
  constexpr int kSteps = 240;
  for (int n = 0; n <= kSteps; ++n) {
    const double s = double(n) / kSteps;
    one.path.push_back({{8 + 52 * s, 20 + 8 * std::sin(kTurn * 1.1 * s),
                         -1.8 - 0.9 * std::sin(kTurn * 2.2 * s - 1.3)}});
  }
  return one;
}

Example brush() {
  Example one{{}, ConeEndShape{16, 90, 30}, {}, 25};
  one.settings.stock = BoxStock{{0, 0, -8}, {64, 62, 0}};
  one.settings.pitch_mm = 0.2;
  for (const std::vector<Dab>& dabs : std::vector<std::vector<Dab>>{
           {{25, 59, 0.6}, {29, 56.5, 3.6}, {33, 53, 5.6}, {33.5, 50.5, 2.5}},
           {{19, 43.5, 3.4},
            {21.5, 43, 2.6},
            {27, 44, 2.6},
            {32, 45.5, 5},
            {33, 42, 4.8},
            {32.5, 28, 4},
            {32.5, 13, 4.4},
            {31, 7.5, 5},
            {28.5, 9, 2.6},
            {24.5, 13, 0.4}},
           {{8, 31, 2.8},
            {12, 31, 2.6},
            {18, 32.5, 2.8},
            {23.5, 34, 4.4},
            {21.5, 27, 3.6},
            {15, 16.5, 2.4},
            {6, 8.5, 0.4}},
           {{52, 46, 5}, {49, 42.5, 4}, {43, 36.5, 2.6}, {36, 31, 0.5}},
           {{34.5, 32.5, 0.8},
            {39, 25, 2.6},
            {45, 16.5, 4.6},
            {51, 10.5, 7},
            {55, 9, 4.6},
            {61, 9, 0.4}}}) {
    append_stroke(dabs, one.path);
  }
  return one;
}

Vec3 front_point(double x, double y) {
  return {x, y,
          -4.2 + 2.4 * std::cos(kTurn * (x - 40) / 62) * std::cos(kTurn * (y - 25) / 90) -
              0.035 * (x - 40) * (x - 40) / 40};
}

Vec3 front_normal(double x, double y) {
  constexpr double kD = 0.01;
  return normalized({front_point(x - kD, y).z - front_point(x + kD, y).z,
                     front_point(x, y - kD).z - front_point(x, y + kD).z, 2 * kD});
}

Example furniture(std::size_t* spirals) {
  Example one{{}, TaperShape{3, 6, 30, TaperTip::kBall}, {}, 40};
  one.settings.stock = BoxStock{{0, 0, -14}, {80, 50, 0}};
  one.settings.pitch_mm = 0.25;
  constexpr int kRows = 84, kPlaces = 81;
  for (int row = 0; row <= kRows; ++row) {
    for (int n = 0; n <= kPlaces; ++n) {
      const double x = 80.0 * (row % 2 == 0 ? n : kPlaces - n) / kPlaces;
      one.path.push_back(pose_on_front(x, 50.0 * row / kRows, 0));
    }
  }
  const std::size_t surface = one.path.size();
  constexpr auto kRetracted = [](ToolPose pose) {
    constexpr double kAlongAxisMm = 7;
    return ToolPose{pose.tip_mm + pose.axis * kAlongAxisMm, pose.axis};
  };
  one.path.push_back(kRetracted(one.path.back()));
  for (const double side : {-1.0, 1.0}) {
    constexpr int kSteps = 260;
    std::vector<ToolPose> spiral;
    for (int n = 0; n <= kSteps; ++n) {
      const double s = double(n) / kSteps, r = 2.2 + 15 * s, a = kTurn * (2.15 * s + 0.28);
      spiral.push_back(pose_on_front(40 + side * (20 + r * std::cos(a)), 25 + 1.1 * r * std::sin(a),
                                     1.5 * std::sqrt(std::min(1.0, 6 * (1 - s)))));
    }
    append_between(spiral, kRetracted, one.path);
  }
  if (spirals != nullptr) *spirals = one.path.size() - surface;
  return one;
}

Sculpture block_of(const SculptureSettings& settings, const ToolShape& shape) {
  Sculpture block = Sculpture::create(settings).value();
  block.apply(DefineTool{1, make_tool(shape).value()}).value();
  return block;
}

Carved carve(const Example& example) {
  Carved carved{block_of(example.settings, example.shape), {}};
  for (std::size_t n = 1; n < example.path.size(); ++n) {
    const ToolPose &from = example.path[n - 1], &to = example.path[n];
    const double seconds = length(to.tip_mm - from.tip_mm) / example.speed_mm_per_s;
    carved.steps.push_back({from, to, carved.block.apply(MoveTool{1, from, to, seconds}).value()});
  }
  return carved;
}

}  // namespace kerf::paper
