// SPDX-License-Identifier: Apache-2.0
#include "server/formats/program_path.h"

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>

namespace kerf {
namespace {

// First and last tolerance tried, in diagonals of the path's extents.
constexpr double kFirstTolerance = 1e-5, kLastTolerance = 0.2;
constexpr double kToleranceStep = 2;
// Greatest distance of a point from the joined path, in tolerances. A point and the end of its run
// are each within one of the line along which the run began, and a run may end one short of it.
constexpr double kPathErrorPerTolerance = 3;

/// Passes on the points of a path until the receiver returns false.
using Points = std::function<void(const std::function<bool(const PathPoint&)>&)>;

/// Joins points that stay within a tolerance of the line along which they began and do not turn
/// back.
class Joiner {
 public:
  Joiner(double tolerance_mm, std::size_t points_max)
      : tolerance_mm_(tolerance_mm), points_max_(points_max) {}

  /// Returns false if the path has too many points.
  bool add(const PathPoint& point) {
    if (!last_) {
      keep(point);
    } else if (!goes_on(point)) {
      if (has_run_) keep(*last_);
      has_line_ = false;
      if (is_break(point)) {
        keep(point);
      } else {
        has_run_ = goes_on(point);
      }
    } else {
      has_run_ = true;
    }
    last_ = point;
    return points_.size() < points_max_;
  }
  std::vector<PathPoint> take() {
    if (has_run_) points_.push_back(*last_);
    return std::move(points_);
  }

 private:
  bool is_break(const PathPoint& point) const { return point.kind == PathKind::kStart; }
  void keep(const PathPoint& point) {
    points_.push_back(point);
    has_run_ = false;
  }
  bool goes_on(const PathPoint& point) {
    if (is_break(point)) return false;
    if (has_run_ && (point.kind != last_->kind || point.tool != last_->tool)) return false;
    const Vec3 away = point.tip_mm - points_.back().tip_mm;
    if (!has_line_) {
      const double far_mm = length(away);
      if (far_mm <= tolerance_mm_ || far_mm == 0) return true;
      has_line_ = true;
      along_ = away * (1 / far_mm);
      reached_mm_ = far_mm;
      return true;
    }
    const double reach = dot(away, along_);
    if (reach < reached_mm_ - tolerance_mm_) return false;
    if (length(away - along_ * reach) > tolerance_mm_) return false;
    reached_mm_ = std::max(reached_mm_, reach);
    return true;
  }

  double tolerance_mm_;
  std::size_t points_max_;
  std::vector<PathPoint> points_;
  std::optional<PathPoint> last_;  ///< of the run since the last point of `points_`, if `has_run_`
  bool has_run_ = false, has_line_ = false;
  Vec3 along_;
  double reached_mm_ = 0;
};

std::optional<std::vector<PathPoint>> joined(const Points& points, double tolerance_mm,
                                             std::size_t points_max) {
  Joiner joiner(tolerance_mm, points_max);
  bool fits = true;
  points([&](const PathPoint& point) { return fits = joiner.add(point); });
  if (!fits) return std::nullopt;
  return joiner.take();
}

/// Every step-th of `count` points, and the last one.
std::vector<PathPoint> every(const Points& points, std::size_t step, std::size_t count) {
  std::vector<PathPoint> kept;
  std::size_t n = 0;
  bool jumps = false;
  points([&](const PathPoint& point) {
    jumps = jumps || point.kind == PathKind::kStart;
    if (n++ % step != 0 && n != count) return true;
    kept.push_back(point);
    if (std::exchange(jumps, false)) kept.back().kind = PathKind::kStart;
    return true;
  });
  return kept;
}

/// The points of a list.
Points all_of(const std::vector<PathPoint>& list) {
  return [&list](const auto& pass_on) { (void)std::ranges::all_of(list, pass_on); };
}

ProgramPath thinned(const Points& points, std::size_t points_max) {
  points_max = std::max<std::size_t>(points_max, 2);
  std::optional<Vec3> low, high;
  std::size_t count = 0;
  points([&](const PathPoint& point) {
    const Vec3 p = point.tip_mm;
    const Vec3 l = low.value_or(p), h = high.value_or(p);
    low = {std::min(l.x, p.x), std::min(l.y, p.y), std::min(l.z, p.z)};
    high = {std::max(h.x, p.x), std::max(h.y, p.y), std::max(h.z, p.z)};
    return ++count > 0;
  });
  const double extent_mm = low ? length(*high - *low) : 0;
  if (auto all = joined(points, 0, points_max)) return {*std::move(all), 0};
  for (double share = kFirstTolerance; share < kLastTolerance; share *= kToleranceStep) {
    const double tolerance_mm = share * extent_mm;
    if (auto fewer = joined(points, tolerance_mm, points_max)) {
      return {*std::move(fewer), kPathErrorPerTolerance * tolerance_mm};
    }
  }
  const std::size_t step = (count + points_max - 2) / (points_max - 1);
  return {every(points, step, count), extent_mm};
}

}  // namespace

void PathCollector::add(const ProgramMotion& motion) {
  if (!at_ || *at_ != motion.from)
    add(PathPoint{motion.from.tip_mm, motion.line, motion.tool, PathKind::kStart, time_s_});
  at_ = motion.to;
  time_s_ += motion.duration_s;
  add(PathPoint{motion.to.tip_mm, motion.line, motion.tool,
                motion.rapid ? PathKind::kRapid : PathKind::kFeed, time_s_});
}

void PathCollector::add(const PathPoint& point) {
  const Vec3 p = point.tip_mm;
  if (!extents_) extents_ = {p, p};
  Vec3 &low = extents_->min_mm, &high = extents_->max_mm;
  low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
  high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  held_.push_back(point);
  if (held_.size() >= kHeld) join_held();
}

/// Joins the held points to the path before them.
void PathCollector::join_held() {
  const double extent_mm = length(extents_->max_mm - extents_->min_mm);
  const auto join = [this](const std::vector<PathPoint>& points) {
    return *joined(all_of(points), tolerance_mm_, points.size() + 1);
  };
  const std::vector<PathPoint> next = join(held_);
  joined_.insert(joined_.end(), next.begin(), next.end());
  held_.clear();
  while (joined_.size() > kHeld / 2) {
    tolerance_mm_ = std::max(kToleranceStep * tolerance_mm_, kFirstTolerance * extent_mm);
    if (tolerance_mm_ < kLastTolerance * extent_mm) {
      error_mm_ += kPathErrorPerTolerance * tolerance_mm_;
      joined_ = join(joined_);
    } else {
      joined_ = every(all_of(joined_), 2, joined_.size());
      error_mm_ = extent_mm;
    }
  }
}

ProgramPath PathCollector::take() {
  if (!joined_.empty()) {
    join_held();
    held_ = std::exchange(joined_, {});
  }
  ProgramPath path = drawn_path(ProgramPath{std::move(held_), error_mm_}, points_max_);
  if (extents_)
    path.error_mm = std::min(path.error_mm, length(extents_->max_mm - extents_->min_mm));
  return path;
}

ProgramPath drawn_path(const Program& program, std::size_t points_max) {
  PathCollector collector(points_max);
  for (const ProgramMotion& motion : program.motions) collector.add(motion);
  return collector.take();
}

ProgramPath drawn_path(const ProgramPath& path, std::size_t points_max) {
  ProgramPath fewer = thinned(all_of(path.points), points_max);
  fewer.error_mm += path.error_mm;
  return fewer;
}

}  // namespace kerf
