#include "kernel/force/cut_sum.h"

#include <algorithm>
#include <cmath>

#include "kernel/force/surface_weight.h"
#include "kernel/math/lanes.h"

namespace kerf {
namespace {

constexpr int kLanes = RemovedGroup::kLanes;

/// Dimensionless. Where a tool's points differ in their ways by less than this part of the tip's,
/// all elements push in one direction, that of their middle. Directions err by its square, torque
/// by it times the spread of the elements.
constexpr double kCommonWay = 1e-3;

/// Segments longer than this part of the tool's reach are weighted at two points: 1/64 of a tool is
/// what its normal changes little over.
constexpr double kShortSegment = 1.0 / 64;

/// Sums lane by lane: of volumes, of volume x place, of volume x direction, of its moment.
struct LaneSums {
  double volume[kLanes] = {};
  double x[kLanes] = {}, y[kLanes] = {}, z[kLanes] = {};
  double push_x[kLanes] = {}, push_y[kLanes] = {}, push_z[kLanes] = {};
  double turn_x[kLanes] = {}, turn_y[kLanes] = {}, turn_z[kLanes] = {};
};

double total(const double* lanes) {
  double sum = 0;
  for (int c = 0; c < kLanes; ++c) sum += lanes[c];
  return sum;
}
Vec3 total(const double* x, const double* y, const double* z) {
  return {total(x), total(y), total(z)};
}

/// A group as the force sees it: middles of the segments from the tip, and their lengths (mm).
struct GroupSegments {
  GroupPoints middle;
  double length[kLanes];
};

/// Where the tip is in the grid's own numbers, so that points come out from the tip.
struct TipInGrid {
  double i, j, k, pitch_mm, quantum_mm;
};

inline __attribute__((always_inline)) void place(const RemovedGroup& g, const TipInGrid& tip,
                                                 GroupSegments& out) {
  const double x = (g.i - tip.i) * tip.pitch_mm;
  out.middle.y = (g.j - tip.j) * tip.pitch_mm;
  for (int c = 0; c < kLanes; ++c) {
    const double bottom = g.bottom[c], top = g.top[c];
    out.middle.x[c] = x + c * tip.pitch_mm;
    out.middle.z[c] = ((bottom + top) * 0.5 - tip.k) * tip.quantum_mm;
    out.length[c] = (top - bottom) * tip.quantum_mm;
  }
}

/// Multiplies each segment by the part of it that counts.
void weigh(const SurfaceWeight& surface, Vec3 axis, double short_mm, GroupSegments& group) {
  double weight[kLanes];
  if (*std::max_element(group.length, group.length + kLanes) <= short_mm) {
    surface.evaluate(group.middle, axis, weight);
    for (int c = 0; c < kLanes; ++c) group.length[c] *= weight[c];
    return;
  }
  // Gauss's two points, a half and 1/√12 of the length apart from the middle.
  constexpr double kGauss = 0.28867513459481287;
  GroupPoints low = group.middle, high = group.middle;
  for (int c = 0; c < kLanes; ++c) {
    low.z[c] -= kGauss * group.length[c];
    high.z[c] += kGauss * group.length[c];
  }
  double other[kLanes];
  surface.evaluate(low, axis, weight);
  surface.evaluate(high, axis, other);
  for (int c = 0; c < kLanes; ++c) group.length[c] *= (weight[c] + other[c]) * 0.5;
}

KERF_VECTOR_CLONES
void add_moments(const GroupSegments& group, LaneSums& s) {
  for (int c = 0; c < kLanes; ++c) {
    const double v = group.length[c];
    s.volume[c] += v;
    s.x[c] += v * group.middle.x[c];
    s.y[c] += v * group.middle.y;
    s.z[c] += v * group.middle.z[c];
  }
}

/// The same for all groups of a translation that are not weighted: nothing else is needed of them.
KERF_VECTOR_CLONES
void add_moments(std::span<const RemovedGroup> groups, const TipInGrid& tip, LaneSums& sums) {
  LaneSums s;
  for (const RemovedGroup& g : groups) {
    GroupSegments group;
    place(g, tip, group);
    for (int c = 0; c < kLanes; ++c) {
      const double v = group.length[c];
      s.volume[c] += v;
      s.x[c] += v * group.middle.x[c];
      s.y[c] += v * group.middle.y;
      s.z[c] += v * group.middle.z[c];
    }
  }
  sums = s;
}

/// Adds pushes of elements that each go their own way, and their moments about the pivot.
KERF_VECTOR_CLONES
void add_pushes(const GroupSegments& group, const Twist& twist, Vec3 pivot, LaneSums& s) {
  const Vec3 v = twist.travel_mm, w = twist.turn_rad;
  for (int c = 0; c < kLanes; ++c) {
    const double x = group.middle.x[c], y = group.middle.y, z = group.middle.z[c];
    const double way_x = v.x + (w.y * z - w.z * y);
    const double way_y = v.y + (w.z * x - w.x * z);
    const double way_z = v.z + (w.x * y - w.y * x);
    const double n = std::sqrt(way_x * way_x + way_y * way_y + way_z * way_z);
    const double scale = n > 0 ? -group.length[c] / n : 0;
    const double fx = way_x * scale, fy = way_y * scale, fz = way_z * scale;
    const double ax = x - pivot.x, ay = y - pivot.y, az = z - pivot.z;
    s.push_x[c] += fx;
    s.push_y[c] += fy;
    s.push_z[c] += fz;
    s.turn_x[c] += ay * fz - az * fy;
    s.turn_y[c] += az * fx - ax * fz;
    s.turn_z[c] += ax * fy - ay * fx;
  }
}

}  // namespace

CutSum sum_cut(std::span<const RemovedGroup> groups, const DexelGrid& grid, const Twist& twist,
               const CutFrame& frame, const SurfaceWeight* weight) {
  const double pitch = grid.pitch_mm, quantum = grid.z_quantum_mm;
  const Vec3 from_origin = frame.tip_mm - grid.origin_mm;
  const TipInGrid tip{from_origin.x / pitch - 0.5, from_origin.y / pitch - 0.5,
                      from_origin.z / quantum, pitch, quantum};
  const Vec3 pivot = frame.axis * frame.pivot_mm;
  const bool common =
      length(twist.turn_rad) * frame.reach_mm <= kCommonWay * length(twist.travel_mm);
  LaneSums sums;
  if (common && weight == nullptr) {
    add_moments(groups, tip, sums);
  } else {
    for (const RemovedGroup& g : groups) {
      GroupSegments group;
      place(g, tip, group);
      if (weight != nullptr) weigh(*weight, frame.axis, kShortSegment * frame.reach_mm, group);
      add_moments(group, sums);
      if (!common) add_pushes(group, twist, pivot, sums);
    }
  }
  const double area = pitch * pitch;
  CutSum sum{total(sums.volume) * area, total(sums.x, sums.y, sums.z) * area, {}, {}};
  if (common) {
    const Vec3 push = -normalized(twist.at(sum.center_mm()));
    sum.push_mm3 = push * sum.volume_mm3;
    sum.turn_mm4 = cross(sum.moment_mm4 - pivot * sum.volume_mm3, push);
  } else {
    sum.push_mm3 = total(sums.push_x, sums.push_y, sums.push_z) * area;
    sum.turn_mm4 = total(sums.turn_x, sums.turn_y, sums.turn_z) * area;
  }
  sum.turn_mm4 = sum.turn_mm4 - frame.axis * dot(sum.turn_mm4, frame.axis);
  return sum;
}

}  // namespace kerf
