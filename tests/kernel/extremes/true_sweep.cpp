// SPDX-License-Identifier: Apache-2.0
#include "tests/kernel/extremes/true_sweep.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "tests/support/swept_oracle.h"

namespace kerf::test {
namespace {

/// A point in the tool's half-plane: distance from the axis, height above the tip.
struct InTool {
  double radial, height;
};

InTool in_tool(const ToolPose& pose, Vec3 point) {
  const Vec3 p = point - pose.tip_mm;
  const double height = dot(p, pose.axis);
  return {length(p - pose.axis * height), height};
}

double outside_tool(const Tool& tool, InTool p) {
  double best = std::numeric_limits<double>::infinity();
  for (const ToolPiece& piece : tool.pieces) {
    best = std::min(best, outside(piece, std::abs(p.radial), p.height));
  }
  return best;
}

/// Returns the least value in [a, b] by golden section.
template <class F>
double golden(double a, double b, F value) {
  constexpr double kShare = 0.3819660112501051;
  double m1 = a + (b - a) * kShare, m2 = b - (b - a) * kShare;
  double f1 = value(m1), f2 = value(m2);
  double best = std::min({f1, f2, value(a), value(b)});
  for (int i = 0; i < 48 && b - a > 1e-17; ++i) {
    if (f1 < f2) {
      b = m2, m2 = m1, f2 = f1;
      m1 = a + (b - a) * kShare, f1 = value(m1);
    } else {
      a = m1, m1 = m2, f1 = f2;
      m2 = b - (b - a) * kShare, f2 = value(m2);
    }
    best = std::min({best, f1, f2});
  }
  return best;
}

struct Cell {
  std::int64_t index;
  double value;
};

}  // namespace

TrueSweep::TrueSweep(const Tool& tool, const ToolPose& from, const ToolPose& to)
    : tool_(tool),
      from_{from.tip_mm, normalized(from.axis)},
      to_{to.tip_mm, normalized(to.axis)},
      angle_(std::atan2(length(cross(from_.axis, to_.axis)), dot(from_.axis, to_.axis))) {}

ToolPose TrueSweep::at(double share) const {
  const Vec3 tip = from_.tip_mm * (1 - share) + to_.tip_mm * share;
  if (angle_ < 1e-15) return {tip, from_.axis};
  const double s = std::sin(angle_);
  return {tip, from_.axis * (std::sin((1 - share) * angle_) / s) +
                   to_.axis * (std::sin(share * angle_) / s)};
}

/// Bisects the time repeatedly and drops intervals that are too far away to matter, until the tool
/// moves by a small part of its size within a cell; then a golden section around each lowest cell.
template <class F>
double TrueSweep::least(Vec3 point, double interest_mm, F value) const {
  const double arm = std::max(length(point - from_.tip_mm), length(point - to_.tip_mm));
  const double speed = length(to_.tip_mm - from_.tip_mm) + angle_ * arm;
  const double fine = std::max(0.02 * tool_.radius_mm, 1e-6);
  std::int64_t cells = 1;
  std::vector<Cell> kept{{0, value(0.5)}}, next;
  double best = std::min(value(0.0), value(1.0));
  const bool turns = angle_ > 1e-15;
  while (speed / double(cells) > fine || (turns && (cells < 16 || angle_ / double(cells) > 0.05))) {
    cells *= 2;
    next.clear();
    for (const Cell& c : kept) {
      for (const std::int64_t index : {2 * c.index, 2 * c.index + 1}) {
        const double v = value((double(index) + 0.5) / double(cells));
        best = std::min(best, v);
        if (v - speed / double(cells) / 2 <= std::min(best, interest_mm))
          next.push_back({index, v});
      }
    }
    kept.swap(next);
  }
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const Cell& c = kept[i];
    const auto lower = [&](std::size_t other, std::int64_t index) {
      return other < kept.size() && kept[other].index == index && kept[other].value < c.value;
    };
    if (lower(i - 1, c.index - 1) || lower(i + 1, c.index + 1)) continue;
    const double a = std::max(0.0, (double(c.index) - 0.5) / double(cells));
    const double b = std::min(1.0, (double(c.index) + 1.5) / double(cells));
    best = std::min(best, golden(a, b, value));
  }
  return best;
}

double TrueSweep::outside(Vec3 point, double interest_mm) const {
  return least(point, interest_mm,
               [&](double share) { return outside_tool(tool_, in_tool(at(share), point)); });
}

bool TrueSweep::well_inside(Vec3 point, double margin_mm) const {
  const auto farthest_out = [&](double share) {
    const InTool p = in_tool(at(share), point);
    double most = -std::numeric_limits<double>::infinity();
    for (int k = 0; k < 8; ++k) {
      const double a = k * std::numbers::pi / 4;
      const InTool q{p.radial + margin_mm * std::cos(a), p.height + margin_mm * std::sin(a)};
      most = std::max(most, outside_tool(tool_, q));
    }
    return most;
  };
  return least(point, 0, farthest_out) < 0;
}

}  // namespace kerf::test
