// SPDX-License-Identifier: Apache-2.0
#include "server/formats/kept_arcs.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "server/formats/arc_fit.h"
#include "server/formats/control/arc.h"
#include "server/formats/pose_grid.h"

namespace kerf {
namespace {

/// Number of chords of one arc: the most kept in memory, and the fewest that identify an arc.
constexpr std::size_t kChordsMax = 100'000, kChordsMin = 2;
/// Greatest relative difference of the durations of an arc's chords, below the digits of F.
constexpr double kDurationShare = 1e-6;
/// Greatest difference of the radii at both ends, mm. Controls accept more.
constexpr double kRadiiMm = 0.02;
constexpr int kCenterSteps = 8;
/// A center is written with the fewest decimals that make the same chords.
constexpr int kCenterDecimalsMin = 3, kCenterDecimalsMax = 6;

bool is_chord(const ProgramMotion& motion) {
  return !motion.rapid && !(motion.from == motion.to) && motion.from.axis == motion.to.axis &&
         motion.line > 0;
}

bool follows(const ProgramMotion& before, const ProgramMotion& motion) {
  return before.to == motion.from && before.tool == motion.tool && before.line == motion.line &&
         before.file == motion.file &&
         std::abs(before.duration_s - motion.duration_s) <= kDurationShare * before.duration_s;
}

// The center of the circle through three points of a plane, or nullopt if they are on a line.
std::optional<PlanePoint> center_of(PlanePoint a, PlanePoint b, PlanePoint c) {
  const double bx = b.first - a.first, by = b.second - a.second;
  const double cx = c.first - a.first, cy = c.second - a.second;
  const double twice = 2 * (bx * cy - by * cx);
  const double size = std::hypot(bx, by) * std::hypot(cx, cy);
  if (!(std::abs(twice) > 1e-9 * size)) return std::nullopt;
  const double b2 = bx * bx + by * by, c2 = cx * cx + cy * cy;
  return PlanePoint{a.first + (cy * b2 - by * c2) / twice, a.second + (bx * c2 - cx * b2) / twice,
                    0};
}

double rounded(double value, int decimals) {
  const double unit = std::pow(10.0, decimals);
  return std::round(value * unit) / unit;
}

// Moves a center so that the radii of the ends of equal chords change uniformly between those of
// the first and the last one, by the method of Gauss and Newton.
PlanePoint with_uniform_radii(std::span<const ProgramMotion> motions, ArcPlane plane,
                              PlanePoint center) {
  const auto count = static_cast<double>(motions.size());
  const PlanePoint first = in_plane(motions.front().from.tip_mm, plane);
  const PlanePoint last = in_plane(motions.back().to.tip_mm, plane);
  struct Ray {
    double length, first, second;
  };
  for (int step = 0; step < kCenterSteps; ++step) {
    const auto ray = [&](PlanePoint at) {
      const double dx = at.first - center.first, dy = at.second - center.second;
      const double radius = std::hypot(dx, dy);
      return Ray{radius, -dx / radius, -dy / radius};
    };
    const Ray a = ray(first), b = ray(last);
    double xx = 0, xy = 0, yy = 0, x = 0, y = 0;
    for (std::size_t n = 0; n + 1 < motions.size(); ++n) {
      const double share = static_cast<double>(n + 1) / count;
      const Ray r = ray(in_plane(motions[n].to.tip_mm, plane));
      const double off = r.length - (1 - share) * a.length - share * b.length;
      const double gx = r.first - (1 - share) * a.first - share * b.first;
      const double gy = r.second - (1 - share) * a.second - share * b.second;
      xx += gx * gx, xy += gx * gy, yy += gy * gy, x += gx * off, y += gy * off;
    }
    const double determinant = xx * yy - xy * xy;
    if (!(determinant > 0)) return center;
    center.first -= (x * yy - y * xy) / determinant;
    center.second -= (y * xx - x * xy) / determinant;
  }
  return center;
}

// The angle that the chords turn about the center, > 0 counterclockwise.
double turn_of(std::span<const ProgramMotion> motions, const FittedArc& arc) {
  double turn = 0;
  const auto angle = [&](const ToolPose& pose) {
    const PlanePoint at = in_plane(pose.tip_mm, arc.plane);
    return std::atan2(at.second - arc.center.second, at.first - arc.center.first);
  };
  for (const ProgramMotion& motion : motions)
    turn += std::remainder(angle(motion.to) - angle(motion.from), 2 * std::numbers::pi);
  return turn;
}

}  // namespace

WriteResult KeptArcs::add(const ProgramMotion& motion) {
  const bool chord = is_chord(motion);
  if (!parts_.empty() && (!chord || !follows(parts_.back(), motion) || parts_.size() >= kChordsMax))
    if (auto done = flush(); !done) return done;
  if (!chord) return writer_->add(motion);
  parts_.push_back(motion);
  return {};
}

WriteResult KeptArcs::flush() {
  const std::vector<ProgramMotion> parts = std::exchange(parts_, {});
  return write(parts);
}

WriteResult KeptArcs::write(Motions motions) {
  const auto arc = motions.size() < kChordsMin ? std::nullopt : arc_of(motions);
  if (!arc) {
    for (const ProgramMotion& motion : motions)
      if (auto written = writer_->add(motion); !written) return written;
    return {};
  }
  // Controls disagree about arcs of nearly a turn.
  if (std::abs(turn_of(motions, *arc)) > kArcSweepMaxDeg * std::numbers::pi / 180) {
    const std::size_t half = motions.size() / 2;
    if (auto written = write(motions.first(half)); !written) return written;
    return write(motions.subspan(half));
  }
  ProgramMotion whole = motions.front();
  whole.to = motions.back().to;
  whole.duration_s = 0;
  for (const ProgramMotion& motion : motions) whole.duration_s += motion.duration_s;
  return writer_->add_arc(whole, *arc);
}

std::optional<FittedArc> KeptArcs::arc_of(Motions motions) const {
  const std::size_t third = std::max<std::size_t>(1, motions.size() / 3);
  const Vec3 start = motions.front().from.tip_mm;
  const Vec3 middle = motions[third - 1].to.tip_mm;
  const Vec3 later = motions[std::min(2 * third, motions.size()) - 1].to.tip_mm;
  for (const ArcPlane plane : {ArcPlane::kXy, ArcPlane::kZx, ArcPlane::kYz}) {
    const PlanePoint a = in_plane(start, plane);
    const auto circle = center_of(a, in_plane(middle, plane), in_plane(later, plane));
    if (!circle) continue;
    const PlanePoint center = with_uniform_radii(motions, plane, *circle);
    FittedArc arc{.plane = plane,
                  .center = {},
                  .counterclockwise = false,
                  .helical = a.normal != in_plane(motions.back().to.tip_mm, plane).normal,
                  .keeps_center = within_mm_ == 0};
    for (int decimals = kCenterDecimalsMin; decimals <= kCenterDecimalsMax; ++decimals) {
      arc.center = {a.first + rounded(center.first - a.first, decimals),
                    a.second + rounded(center.second - a.second, decimals), 0};
      arc.counterclockwise = turn_of(motions, arc) > 0;
      if (writer_->takes(arc) && makes(arc, motions)) return arc;
    }
  }
  return std::nullopt;
}

// Whether a reader divides the arc into these motions.
bool KeptArcs::makes(const FittedArc& arc, Motions motions) const {
  const Vec3 start = motions.front().from.tip_mm, end = motions.back().to.tip_mm;
  const PlanePoint a = in_plane(start, arc.plane), b = in_plane(end, arc.plane);
  // Like the writer, which writes a whole turn in two parts.
  const bool whole = a.first == b.first && a.second == b.second;
  const bool kept = whole || arc.keeps_center;
  const PlanePoint center = (kept ? arc : with_equal_radii(arc, start, end)).center;
  const PlanePoint written{a.first + rounded(center.first - a.first, kCenterDecimalsMax),
                           a.second + rounded(center.second - a.second, kCenterDecimalsMax), 0};
  const Arc read = arc_about(start, end, arc.plane, written, arc.counterclockwise ? 1 : -1);
  if (std::abs(read.start_radius - read.end_radius) > kRadiiMm) return false;
  if (std::cmp_not_equal(read.chords(scene_.settings.tolerance_mm), motions.size())) return false;
  const auto count = static_cast<double>(motions.size());
  for (std::size_t n = 0; n < motions.size(); ++n) {
    const ToolPose& made = motions[n].to;
    const ToolPose again =
        admit_pose({read.at(static_cast<double>(n + 1) / count), motions[n].to.axis});
    const bool same = again == made;
    if (!same && !(length(again.tip_mm - made.tip_mm) <= within_mm_ && within_mm_ > 0))
      return false;
  }
  return true;
}

WriteResult KeptArcs::add_hole(const ProgramMotion& first, const DrilledHole& hole) {
  if (auto done = flush(); !done) return done;
  return writer_->add_hole(first, hole);
}

WriteResult KeptArcs::remark(const MachineRemark& said) {
  if (auto done = flush(); !done) return done;
  return writer_->remark(said);
}

WriteResult KeptArcs::finish() {
  if (auto done = flush(); !done) return done;
  return writer_->finish();
}

}  // namespace kerf
