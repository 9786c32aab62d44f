// SPDX-License-Identifier: Apache-2.0
#include "server/verify/tool_profile.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kerf {
namespace {

// Samples of an interval between two ends of pieces, to find the widest piece.
constexpr int kLooks = 64;
constexpr int kBisections = 60;
// Differences of radii below this are rounding, mm.
constexpr double kSameMm = 1e-10;

// The widest piece at a height; `likely` if it is as wide as any.
std::size_t widest(const std::vector<ToolPiece>& pieces, double h, std::size_t likely) {
  std::size_t best = likely;
  for (std::size_t i = 0; i < pieces.size(); ++i)
    if (radius_at(pieces[i], h) > radius_at(pieces[best], h) + kSameMm) best = i;
  return best;
}

}  // namespace

ToolProfile::ToolProfile(const Tool& tool) : pieces_(tool.pieces) {
  std::vector<double> ends;
  for (const ToolPiece& piece : pieces_) {
    const Extent e = extent(piece);
    ends.push_back(e.z0_mm);
    ends.push_back(e.z1_mm);
  }
  std::ranges::sort(ends);
  low_mm_ = ends.front();
  high_mm_ = ends.back();
  double reached = 0;  // radius that the outline has reached
  for (std::size_t e = 1; e < ends.size(); ++e) {
    double low = ends[e - 1];
    const double high = ends[e];
    if (high - low < kSameMm) continue;
    const double step = (high - low) / kLooks;
    std::size_t now = widest(pieces_, low + step / 2, 0);
    const auto finish = [&](std::size_t piece, double to) {
      add_step(reached, std::max(0.0, kerf::radius_at(pieces_[piece], low)), low);
      add_outline(pieces_[piece], low, to);
      reached = std::max(0.0, kerf::radius_at(pieces_[piece], to));
      low = to;
    };
    for (int k = 1; k < kLooks; ++k) {
      double in = ends[e - 1] + (k - 0.5) * step;
      double out = in + step;
      const std::size_t next = widest(pieces_, out, now);
      if (next == now) continue;
      for (int n = 0; n < kBisections; ++n) {
        const double middle = (in + out) / 2;
        (widest(pieces_, middle, now) == now ? in : out) = middle;
      }
      finish(now, in);
      now = next;
    }
    finish(now, high);
  }
  add_step(reached, 0, high_mm_);
  convex_ = is_convex();
  for (const Part& part : parts_) radius_mm_ = std::max({radius_mm_, part.a.r, part.b.r});
  for (const ToolPiece& piece : pieces_)
    if (const auto* ball = std::get_if<BallPiece>(&piece))
      radius_mm_ = std::max(radius_mm_, ball->radius_mm);
    else if (const auto* arc = std::get_if<ArcPiece>(&piece))
      radius_mm_ = std::max(radius_mm_, arc->center_r_mm + arc->radius_mm);
}

namespace {

/// Angle of a point of an arc about its center, from straight down to straight up, 0 to pi.
double angle_on(double r, double h) { return std::atan2(r, -h); }

}  // namespace

double ToolProfile::length_of(const Part& part) {
  if (part.radius <= 0) return std::hypot(part.b.r - part.a.r, part.b.h - part.a.h);
  return part.radius * (angle_on(part.b.r - part.center.r, part.b.h - part.center.h) -
                        angle_on(part.a.r - part.center.r, part.a.h - part.center.h));
}

ToolProfile::Point ToolProfile::at_share(const Part& part, double share) {
  if (part.radius <= 0)
    return {part.a.r + share * (part.b.r - part.a.r), part.a.h + share * (part.b.h - part.a.h)};
  const double from = angle_on(part.a.r - part.center.r, part.a.h - part.center.h);
  const double angle = from + share * length_of(part) / part.radius;
  return {part.center.r + part.radius * std::sin(angle),
          part.center.h - part.radius * std::cos(angle)};
}

double ToolProfile::outline_length(double up_to_mm) const {
  double length = 0;
  for (const Part& part : parts_) {
    if (part.a.h >= up_to_mm) break;
    const double share = part.b.h > up_to_mm ? (up_to_mm - part.a.h) / (part.b.h - part.a.h) : 1.0;
    if (part.radius > 0 && share < 1) {
      // The arc up to that height.
      Part cut = part;
      const double h = up_to_mm - part.center.h;
      cut.b = {part.center.r + std::sqrt(std::max(0.0, part.radius * part.radius - h * h)),
               up_to_mm};
      length += length_of(cut);
    } else {
      length += share * length_of(part);
    }
  }
  return length;
}

ToolProfile::OutlinePoint ToolProfile::outline_at(double along_mm) const {
  std::size_t n = 0;
  for (; n + 1 < parts_.size() && along_mm > length_of(parts_[n]); ++n)
    along_mm -= length_of(parts_[n]);
  const double length = length_of(parts_[n]);
  const Point q = at_share(parts_[n], length > 0 ? std::clamp(along_mm / length, 0.0, 1.0) : 0.0);
  const Point normal = normal_of(parts_[n], q);
  return {q.r, q.h, normal.r, normal.h};
}

void ToolProfile::add_step(double from_r, double to_r, double height_mm) {
  if (std::abs(from_r - to_r) > kSameMm)
    parts_.push_back({.a = {from_r, height_mm}, .b = {to_r, height_mm}});
}

void ToolProfile::add_outline(const ToolPiece& piece, double low, double high) {
  Part part{.a = {kerf::radius_at(piece, low), low}, .b = {kerf::radius_at(piece, high), high}};
  if (const auto* ball = std::get_if<BallPiece>(&piece)) {
    part.center = {0, ball->center_mm};
    part.radius = ball->radius_mm;
  } else if (const auto* arc = std::get_if<ArcPiece>(&piece)) {
    part.center = {arc->center_r_mm, arc->center_z_mm};
    part.radius = arc->radius_mm;
  }
  parts_.push_back(part);
}

double ToolProfile::radius_at(double height_mm) const {
  double radius = -1;
  for (const ToolPiece& piece : pieces_)
    radius = std::max(radius, kerf::radius_at(piece, height_mm));
  return radius;
}

bool ToolProfile::is_convex() const {
  constexpr int kSteps = 1024;
  const double step = (high_mm_ - low_mm_) / kSteps;
  for (int i = 1; i < kSteps; ++i) {
    const double h = low_mm_ + i * step;
    if (2 * radius_at(h) < radius_at(h - step) + radius_at(h + step) - 1e-9) return false;
  }
  return true;
}

ToolProfile::Point ToolProfile::nearest_on(const Part& part, Point p) {
  if (part.radius > 0) {
    const double r = p.r - part.center.r;
    const double h = p.h - part.center.h;
    const double n = std::sqrt(r * r + h * h);
    if (n > 0 && r >= 0) {
      const Point q{part.center.r + r * (part.radius / n), part.center.h + h * (part.radius / n)};
      if (q.h >= part.a.h && q.h <= part.b.h) return q;
    }
    const auto squared = [&p](Point q) {
      return (p.r - q.r) * (p.r - q.r) + (p.h - q.h) * (p.h - q.h);
    };
    return squared(part.a) < squared(part.b) ? part.a : part.b;
  }
  const double dr = part.b.r - part.a.r;
  const double dh = part.b.h - part.a.h;
  const double along = ((p.r - part.a.r) * dr + (p.h - part.a.h) * dh) / (dr * dr + dh * dh);
  const double t = std::clamp(along, 0.0, 1.0);
  return {part.a.r + t * dr, part.a.h + t * dh};
}

// The outline is traversed from the tip up, with the tool to its left.
ToolProfile::Point ToolProfile::normal_of(const Part& part, Point q) {
  if (part.radius > 0)
    return {(q.r - part.center.r) / part.radius, (q.h - part.center.h) / part.radius};
  const double dr = part.b.r - part.a.r;
  const double dh = part.b.h - part.a.h;
  const double n = std::sqrt(dr * dr + dh * dh);
  return {dh / n, -dr / n};
}

ToolProfile::Nearest ToolProfile::nearest(double radial_mm, double height_mm) const {
  const Point p{radial_mm, height_mm};
  double best = std::numeric_limits<double>::infinity();
  const Part* nearest_part = nullptr;
  Point nearest_point{0, 0};
  for (const Part& part : parts_) {
    const Point q = nearest_on(part, p);
    const double squared = (p.r - q.r) * (p.r - q.r) + (p.h - q.h) * (p.h - q.h);
    if (squared >= best) continue;
    best = squared;
    nearest_part = &part;
    nearest_point = q;
  }
  const double distance = std::sqrt(best);
  const bool inside =
      height_mm > low_mm_ && height_mm < high_mm_ && radial_mm < radius_at(height_mm);
  const double sign = inside ? -1 : 1;
  if (distance < kSameMm) {
    const Point n = normal_of(*nearest_part, nearest_point);
    return {sign * distance, n.r, n.h};
  }
  return {sign * distance, sign * (p.r - nearest_point.r) / distance,
          sign * (p.h - nearest_point.h) / distance};
}

}  // namespace kerf
