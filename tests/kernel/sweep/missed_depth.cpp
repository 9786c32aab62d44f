// SPDX-License-Identifier: Apache-2.0
#include "tests/kernel/sweep/missed_depth.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <variant>
#include <vector>

#include "kernel/sweep/swept_tool.h"
#include "tests/support/swept_oracle.h"

namespace kerf::test {
namespace {

constexpr double kFloorMm = -80;  ///< below every tool

double within(double share, double a, double b) { return a + (b - a) * share; }
double power(double share, double a, double b) { return std::pow(10.0, within(share, a, b)); }

/// Cylinders, cones that widen or narrow, stacks with hidden discs, arcs, and a disc on a shaft.
ToolShape shape_of(const MissCase& c) {
  const auto& g = c.genes;
  const double r = within(g[0], 1, 8), h = within(g[1], 0.3, 12);
  switch (c.tool) {
    case 0:
      return FlatShape{2 * r, h + 3};
    case 1:
      return ProfileShape{{ProfilePoint{r * g[2], 0}, ProfilePoint{r, h}}};
    case 2:
      return ProfileShape{{ProfilePoint{r, 0}, ProfilePoint{r * g[2], h}}};
    case 3:
      return ProfileShape{{ProfilePoint{r * within(g[2], 0.8, 1.2), 0}, ProfilePoint{r, h},
                           ProfilePoint{r * within(g[3], 0.9, 1.6), h * 2},
                           ProfilePoint{r * within(g[4], 0.9, 1.6), h * 2 + 10}}};
    case 4:
      return BallShape{2 * r, 30};
    case 5:
      return BullNoseShape{2 * r, r * within(g[2], 0.1, 0.9), 30};
    case 6:
      return ProfileShape{{ProfilePoint{r, 0}, ProfilePoint{r, h * 0.2},
                           ProfilePoint{r * 0.4, h * 0.2}, ProfilePoint{r * 0.4, 25}}};
    case 7:
      return ProfileShape{{ProfilePoint{r, 0}, ProfilePoint{r * within(g[2], 0.7, 1), h},
                           ProfilePoint{r * 1.3, h * 1.5}, ProfilePoint{r * 1.3, 30}}};
    case 8:
      return TaperShape{2 * r * g[2] + 0.1, within(g[3], 2, 20), h + 5};
    default:
      return ProfileShape{{ProfilePoint{0, 0}, ProfileArc{{r, r}, r},
                           ProfilePoint{r * within(g[2], 0.6, 1.4), r + h},
                           ProfilePoint{r * 1.4, r + h + 8}}};
  }
}

/// Returns a direction perpendicular to `axis`.
Vec3 across(Vec3 axis, double angle) {
  const Vec3 other = std::abs(axis.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
  const Vec3 e = normalized(cross(axis, other));
  return e * std::cos(angle) + cross(axis, e) * std::sin(angle);
}

struct MissMotion {
  Tool tool;
  ToolPose from, to;
  double tolerance_mm, x_mm, y_mm, pitch_mm;
};

/// Returns the motion of a case, whose rays are at a point of the tool's surface at some share, or
/// nothing if there is no such tool.
std::optional<MissMotion> motion_of(const MissCase& c) {
  const auto tool = make_tool(shape_of(c));
  if (!tool) return std::nullopt;
  const auto& g = c.genes;
  constexpr double kHalfCircle = 3.2;  // slightly more, so that a climb passes it
  const double lean = within(g[5], 0, 1.7), azimuth = within(g[6], -kHalfCircle, kHalfCircle);
  const double turn = power(g[7], -3, -0.5);
  MissMotion m{*tool, {}, {}, power(g[14], -4, -1), 0, 0, power(g[20], -5, -1)};
  m.from.axis = {std::sin(lean) * std::cos(azimuth), std::sin(lean) * std::sin(azimuth),
                 std::cos(lean)};
  const Vec3 side = across(m.from.axis, within(g[8], -kHalfCircle, kHalfCircle));
  m.to.axis = normalized(m.from.axis * std::cos(turn) + side * std::sin(turn));
  const Vec3 travel{within(g[11], -1, 1), within(g[12], -1, 1), within(g[13], -1, 1)};
  m.to.tip_mm = (m.from.axis - m.to.axis) * within(g[9], -20, 60) + travel * power(g[10], -4, 1);

  const ToolPose at = true_pose(m.from, m.to, std::clamp(within(g[15], -0.1, 1.1), 0.0, 1.0));
  const std::size_t count = m.tool.pieces.size();
  const ToolPiece& piece = m.tool.pieces[std::min(count - 1, std::size_t(g[16] * double(count)))];
  const Extent e = extent(piece);
  const double z = within(g[17], e.z0_mm, std::min(e.z1_mm, e.z0_mm + 20));
  const double radius = radius_at(piece, z) * std::min(1.0, g[18] / 0.3);
  const Vec3 point =
      at.tip_mm + at.axis * z + across(at.axis, within(g[19], -kHalfCircle, kHalfCircle)) * radius;
  m.x_mm = point.x - g[21] * kLanes * m.pitch_mm;
  m.y_mm = point.y - g[22] * kBlockSide * m.pitch_mm;
  return m;
}

/// Returns the intervals that the sweep removes from the rays of a motion.
ColumnBlock removed_by(const MissMotion& m, double top_mm) {
  const SweepSettings settings{
      MotionModel::kTight, m.tolerance_mm, {{-1e3, -1e3, kFloorMm}, {1e3, 1e3, top_mm}}};
  ColumnBlock block;
  for (int i = 0; i < kLanes; ++i) block.x_mm.set(i, m.x_mm + i * m.pitch_mm);
  for (int j = 0; j < kBlockSide; ++j) block.y_mm[j] = m.y_mm + j * m.pitch_mm;
  block.top_mm = block.grid_top_mm = top_mm;
  block.lowest_mm = Lanes(-1e9);
  block.clear();
  sweep_tool(m.tool, make_motion(m.from, m.to, m.tool.length_mm), settings,
             [&](const SubMotion& sub) {
               block.join_mm = sub.swept.join_mm;
               for (const SweptPiece& piece : sub.swept.pieces) {
                 block.rows = 0xFF;
                 std::visit([&](const auto& sweep) { sweep.evaluate(block); }, piece);
               }
             });
  return block;
}

/// Returns the intervals of a ray that are not removed.
std::vector<Span> remaining(const ColumnBlock& block, int row, int lane, double top_mm) {
  std::vector<Span> removed;
  const auto take = [&](double lo, double hi) {
    if (lo <= hi) removed.push_back({lo, hi});
  };
  if ((block.filled >> row & 1) != 0) take(block.lo_mm[row][lane], block.hi_mm[row][lane]);
  for (const ColumnBlock::Apart& a : block.apart) {
    if (a.row == row) take(a.lo_mm[lane], a.hi_mm[lane]);
  }
  std::ranges::sort(removed, {}, &Span::lo);
  std::vector<Span> left;
  double z = kFloorMm;
  const auto add = [&](double to) {
    if (to > z + 1e-6) left.push_back({z, to});
  };
  for (const Span& s : removed) {
    add(s.lo);
    z = s.hi;
  }
  add(top_mm);
  return left;
}

/// Returns the abscissa of the least value of a unimodal function.
template <class F>
double least_at(double a, double b, int steps, F value) {
  for (int i = 0; i < steps; ++i) {
    const double m1 = a + (b - a) * 0.382, m2 = b - (b - a) * 0.382;
    (value(m1) < value(m2) ? b : a) = value(m1) < value(m2) ? m2 : m1;
  }
  return (a + b) / 2;
}

/// Returns the depth in a piece, at one pose, of the deepest point of a ray in `left`.
double depth_at_pose(const ToolPiece& piece, const ToolPose& pose, double x, double y,
                     const std::vector<Span>& left, double top_mm) {
  const auto outside_at = [&](double z) { return outside(piece, pose, {x, y, z}); };
  const double deepest = least_at(kFloorMm, top_mm, 34, outside_at);
  double least = 1e9;
  for (const Span& s : left) least = std::min(least, outside_at(std::clamp(deepest, s.lo, s.hi)));
  return -least;
}

/// Returns the greatest depth during the motion: dense poses, then a golden section.
double depth_in(const ToolPiece& piece, const MissMotion& m, double x, double y,
                const std::vector<Span>& left, double top_mm) {
  constexpr int kPoses = 48;
  const auto above = [&](double share) {
    return -depth_at_pose(piece, true_pose(m.from, m.to, share), x, y, left, top_mm);
  };
  double best = 1e9;
  int at = 0;
  for (int i = 0; i <= kPoses; ++i) {
    const double d = above(double(i) / kPoses);
    if (d < best) best = d, at = i;
  }
  if (best > 1) return -best;
  const double a = std::max(0, at - 1) / double(kPoses);
  const double b = std::min(kPoses, at + 1) / double(kPoses);
  return -std::min(best, above(least_at(a, b, 26, above)));
}

}  // namespace

double missed_depth(const MissCase& c, int stride) {
  const auto m = motion_of(c);
  if (!m) return -1;
  const ColumnBlock block = removed_by(*m, c.top_mm);
  double deepest = -1e9;
  for (int n = 0; n < kLanes * kBlockSide; n += stride) {
    const int row = n / kLanes, lane = n % kLanes;
    const std::vector<Span> left = remaining(block, row, lane, c.top_mm);
    for (const ToolPiece& piece : m->tool.pieces) {
      const double depth = depth_in(piece, *m, block.x_mm[lane], block.y_mm[row], left, c.top_mm);
      deepest = std::max(deepest, depth);
    }
  }
  return deepest / m->tolerance_mm;
}

MissCase MissSearch::any_case() {
  MissCase c{static_cast<int>(share() * kMissTools), share() < 0.5 ? 15.0 : 4.0, {}};
  for (double& g : c.genes) g = share();
  if (share() < 0.3) c.genes[5] *= 0.1;   // almost upright
  if (share() < 0.3) c.genes[10] *= 0.3;  // turn about a point of the axis
  return c;
}

MissCase MissSearch::varied(MissCase c) {
  const int count = 1 + static_cast<int>(share() * 4);
  for (int k = 0; k < count; ++k) {
    const double step = share() < 0.5 ? 0.1 : 0.005;
    double& g = c.genes[std::size_t(share() * kMissGenes)];
    g = std::clamp(g + step * (share() * 2 - 1), 0.0, 1.0);
  }
  return c;
}

MissCase MissSearch::near(MissCase c) {
  constexpr double kStep = 0.01;
  for (double& g : c.genes) g = std::clamp(g + kStep * (share() * 2 - 1), 0.0, 1.0);
  return c;
}

template <class Start>
MissCase MissSearch::climb_from(const Start& start, double& depth) {
  constexpr int kFirst = 12, kFailures = 30, kStride = 9;
  MissCase best = start();
  depth = missed_depth(best, kStride);
  const auto take = [&](const MissCase& c) {
    const double d = missed_depth(c, kStride);
    if (!(d > depth + 1e-3 * std::abs(depth))) return false;
    best = c;
    depth = d;
    return true;
  };
  for (int k = 1; k < kFirst; ++k) take(start());
  if (depth < 0.05) return best;
  for (int failures = 0; failures < kFailures;) failures = take(varied(best)) ? 0 : failures + 1;
  depth = missed_depth(best);
  return best;
}

MissCase MissSearch::climb(double& depth) {
  return climb_from([&] { return any_case(); }, depth);
}

MissCase MissSearch::climb_near(const MissCase& c, double& depth) {
  return climb_from([&] { return near(c); }, depth);
}

}  // namespace kerf::test
