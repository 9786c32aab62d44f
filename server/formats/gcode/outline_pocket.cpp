// SPDX-License-Identifier: Apache-2.0
#include "server/formats/gcode/outline_pocket.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "server/formats/control/arc.h"
#include "server/formats/control/compensation.h"

namespace kerf {
namespace {

/// Sagitta of the chords of arcs. Strokes keep the same extra distance, because the chord of an arc
/// around an island cuts into the island.
constexpr double kChordMm = 0.001;
/// Rounding of distances that are exactly the inset.
constexpr double kRoundingMm = 1e-6;
constexpr std::size_t kRowsMax = 2000, kStrokesMax = 20'000;

double sweep_of(const AreaMove& from, const AreaMove& arc) {
  return sweep_rad({from.x, from.y, 0}, {arc.center_x, arc.center_y, 0}, arc.turns,
                   {arc.x, arc.y, 0});
}

void append_chords(std::vector<OutlinePoint>& corners, const AreaMove& from, const AreaMove& to) {
  const double radius = std::hypot(from.x - to.center_x, from.y - to.center_y);
  if (to.turns != 0 && radius > kChordMm) {
    const double sweep = sweep_of(from, to);
    const double most = 2 * std::acos(1 - kChordMm / radius);
    const int count = std::max(1, static_cast<int>(std::ceil(std::abs(sweep) / most)));
    const double start = std::atan2(from.y - to.center_y, from.x - to.center_x);
    for (int i = 1; i < count; ++i) {
      const double angle = start + sweep * i / count;
      corners.push_back(
          {to.center_x + radius * std::cos(angle), to.center_y + radius * std::sin(angle)});
    }
  }
  corners.push_back({to.x, to.y});
}

double distance_of(OutlinePoint at, OutlinePoint a, OutlinePoint b) {
  const double dx = b.x - a.x, dy = b.y - a.y, square = dx * dx + dy * dy;
  const double along =
      square > 0 ? std::clamp(((at.x - a.x) * dx + (at.y - a.y) * dy) / square, 0.0, 1.0) : 0;
  return std::hypot(at.x - a.x - along * dx, at.y - a.y - along * dy);
}

double side_of(OutlinePoint at, OutlinePoint a, OutlinePoint b) {
  return (b.x - a.x) * (at.y - a.y) - (b.y - a.y) * (at.x - a.x);
}

bool do_cross(OutlinePoint a, OutlinePoint b, OutlinePoint c, OutlinePoint d) {
  return side_of(a, c, d) * side_of(b, c, d) < 0 && side_of(c, a, b) * side_of(d, a, b) < 0;
}

using Interval = std::pair<double, double>;

/// The part of the row at `y` that is nearer than `reach` to a chord: one interval, because these
/// points are convex.
std::optional<Interval> part_near(OutlinePoint a, OutlinePoint b, double y, double reach) {
  Interval part{HUGE_VAL, -HUGE_VAL};
  const auto take = [&part](double x) {
    part = {std::min(part.first, x), std::max(part.second, x)};
  };
  for (const OutlinePoint end : {a, b}) {
    const double up = y - end.y;
    if (std::abs(up) >= reach) continue;
    const double half = std::sqrt(reach * reach - up * up);
    take(end.x - half);
    take(end.x + half);
  }
  const double size = std::hypot(b.x - a.x, b.y - a.y);
  if (size > 0) {
    const double nx = -(b.y - a.y) / size * reach, ny = (b.x - a.x) / size * reach;
    for (const double s : {-1.0, 1.0}) {
      const double from = a.y + s * ny, to = b.y + s * ny;
      if (from == to || (y - from) * (y - to) > 0) continue;
      take(a.x + s * nx + (b.x - a.x) * (y - from) / (to - from));
    }
  }
  if (part.first >= part.second) return std::nullopt;
  return part;
}

/// The gaps between the intervals of `near`.
std::vector<Interval> gaps_of(std::vector<Interval> near) {
  std::ranges::sort(near);
  std::vector<Interval> gaps;
  double end = HUGE_VAL;
  for (const Interval& part : near) {
    if (part.first > end) gaps.emplace_back(end, part.first);
    end = end == HUGE_VAL ? part.second : std::max(end, part.second);
  }
  return gaps;
}

}  // namespace

OutlinePocket::OutlinePocket(const AreaPath& outline, double inset)
    : outline_(outline), inset_(inset) {
  corners_.push_back({outline.front().x, outline.front().y});
  for (std::size_t i = 1; i < outline.size(); ++i)
    append_chords(corners_, outline[i - 1], outline[i]);
  corners_.back() = corners_.front();
  for (std::size_t i = 1; i < corners_.size(); ++i)
    doubled_area_ += side_of(corners_[i], corners_.front(), corners_[i - 1]);
}

bool OutlinePocket::is_inside(OutlinePoint at) const {
  bool inside = false;
  for (std::size_t i = 1; i < corners_.size(); ++i) {
    const OutlinePoint a = corners_[i - 1], b = corners_[i];
    if ((a.y > at.y) == (b.y > at.y)) continue;
    if (at.x < a.x + (b.x - a.x) * (at.y - a.y) / (b.y - a.y)) inside = !inside;
  }
  return inside;
}

double OutlinePocket::distance(OutlinePoint at) const {
  double least = HUGE_VAL;
  for (std::size_t i = 1; i < corners_.size(); ++i)
    least = std::min(least, distance_of(at, corners_[i - 1], corners_[i]));
  return least;
}

bool OutlinePocket::is_clear(OutlinePoint at) const {
  return is_inside(at) && distance(at) >= inset_ - kChordMm - kRoundingMm;
}

bool OutlinePocket::is_clear(OutlinePoint from, OutlinePoint to) const {
  if (!is_clear(from) || !is_clear(to)) return false;
  const double least = inset_ - kChordMm - kRoundingMm;
  for (std::size_t i = 1; i < corners_.size(); ++i) {
    const OutlinePoint a = corners_[i - 1], b = corners_[i];
    if (do_cross(from, to, a, b) || distance_of(a, from, to) < least) return false;
  }
  return true;
}

std::expected<std::vector<OutlineStroke>, std::string> OutlinePocket::strokes(double step,
                                                                              bool along_x) const {
  // Rows along y are rows along x of the outline with both axes exchanged.
  std::vector<OutlinePoint> corners = corners_;
  if (!along_x)
    for (OutlinePoint& corner : corners) std::swap(corner.x, corner.y);
  const auto [lowest, highest] = std::ranges::minmax_element(corners, {}, &OutlinePoint::y);
  const double bottom = lowest->y + inset_, height = highest->y - inset_ - bottom;
  std::vector<OutlineStroke> strokes;
  if (!(height > 0)) return strokes;
  if (!(height / step < kRowsMax))
    return std::unexpected("the pocket needs more than " + std::to_string(kRowsMax) + " rows");
  const int rows = static_cast<int>(std::ceil(height / step - 1e-9));
  for (int row = 1; row < rows; ++row) {
    const double y = bottom + height * row / rows;
    std::vector<Interval> near;
    for (std::size_t i = 1; i < corners.size(); ++i)
      if (const auto part = part_near(corners[i - 1], corners[i], y, inset_ + kChordMm))
        near.push_back(*part);
    std::vector<Interval> gaps = gaps_of(std::move(near));
    std::erase_if(gaps, [&](const Interval& gap) {
      const OutlinePoint middle{(gap.first + gap.second) / 2, y};
      return !is_inside(along_x ? middle : OutlinePoint{middle.y, middle.x});
    });
    if (row % 2 == 0) std::ranges::reverse(gaps);
    for (Interval gap : gaps) {
      if (row % 2 == 0) std::swap(gap.first, gap.second);
      const OutlinePoint from{gap.first, y}, to{gap.second, y};
      strokes.push_back(along_x ? OutlineStroke{from, to}
                                : OutlineStroke{{from.y, from.x}, {to.y, to.x}});
    }
    if (strokes.size() > kStrokesMax)
      return std::unexpected("the pocket needs more than " + std::to_string(kStrokesMax) +
                             " strokes");
  }
  return strokes;
}

AreaPath OutlinePocket::loop() const {
  if (inset_ == 0) return outline_;
  std::vector<CompensatedMove> moves;
  CutterCompensation compensation([&](const CompensatedMove& move) { moves.push_back(move); });
  compensation.start(is_counterclockwise() ? 1 : -1, inset_, ArcPlane::kXy);
  // Compensation enters the path next to its first point, which may be a corner. If the path is
  // followed twice, the part between the two ends of the first move is a loop.
  const std::size_t count = outline_.size() - 1;
  const AreaMove& start = outline_.front();
  const auto numbered = [](std::size_t number) {
    CompensatedInfo info;
    info.line = number;
    return info;
  };
  const AreaMove& first = outline_[1];
  const double along = first.turns == 0
                           ? std::atan2(first.y - start.y, first.x - start.x)
                           : std::atan2(start.y - first.center_y, start.x - first.center_x) +
                                 (first.turns > 0 ? 0.5 : -0.5) * std::numbers::pi;
  PlanePoint at = offset_point({start.x, start.y, 0}, 3 * inset_, along + std::numbers::pi);
  at = compensation.straight(false, at, {start.x, start.y, 0}, numbered(0));
  for (std::size_t n = 1; n <= 2 * count; ++n) {
    const AreaMove& move = outline_[(n - 1) % count + 1];
    const PlanePoint end{move.x, move.y, 0};
    if (move.turns == 0) {
      at = compensation.straight(false, at, end, numbered(n));
      continue;
    }
    ArcCenter center;
    center.absolute = true;
    center.ijk = {move.center_x, move.center_y, 0};
    at = compensation.arc(at, end, center, move.turns < 0, 1, HUGE_VAL, numbered(n));
  }
  compensation.flush(at);
  const auto begins = [&moves](std::size_t number) {
    return std::ranges::find_if(
        moves, [number](const CompensatedMove& move) { return move.info.line >= number; });
  };
  const auto from = begins(2), to = begins(count + 2);
  AreaPath loop{{.x = std::prev(from)->end.first, .y = std::prev(from)->end.second}};
  for (auto move = from; move != to; ++move)
    loop.push_back({.x = move->end.first,
                    .y = move->end.second,
                    .turns = move->turns,
                    .center_x = move->center.first,
                    .center_y = move->center.second});
  return loop;
}

}  // namespace kerf
