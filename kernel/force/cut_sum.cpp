// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/cut_sum.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "kernel/force/surface_weight.h"
#include "kernel/math/int_lanes.h"
#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

/// Groups that are processed at once, so that they stay in the first-level cache.
constexpr std::size_t kChunk = 32;

/// Sums per SIMD lane: of volume, volume x position, volume x direction, the moment of that, and
/// volume x the squares of the displacement across and along the rays.
struct LaneSums {
  Lanes volume{}, x{}, y{}, z{};
  Lanes push_x{}, push_y{}, push_z{};
  Lanes turn_x{}, turn_y{}, turn_z{};
  Lanes across2{}, along2{};
};

double total(const Lanes& lanes) {
  double sum = 0;
  for (int c = 0; c < kLanes; ++c) sum += lanes[c];
  return sum;
}
Vec3 total(const Lanes& x, const Lanes& y, const Lanes& z) {
  return {total(x), total(y), total(z)};
}

/// The tip in grid units, for positions relative to the tip.
struct TipInGrid {
  double i, j, k, pitch_mm, quantum_mm;
};

KERF_INLINE GroupSegments placed(const RemovedGroup& g, const TipInGrid& tip) {
  const Lanes beside = lane_numbers() * tip.pitch_mm;
  const Lanes bottom = to_lanes(load_ints(g.bottom)), top = to_lanes(load_ints(g.top));
  GroupSegments out;
  out.middle.x = (g.i - tip.i) * tip.pitch_mm + beside;
  out.middle.y = (g.j - tip.j) * tip.pitch_mm;
  out.middle.z = ((bottom + top) * 0.5 - tip.k) * tip.quantum_mm;
  out.length = (top - bottom) * tip.quantum_mm;
  return out;
}

KERF_INLINE void place_all_in_lanes(std::span<const RemovedGroup> groups, const TipInGrid& tip,
                                    GroupSegments* out) {
  for (std::size_t k = 0; k < groups.size(); ++k) out[k] = placed(groups[k], tip);
}

KERF_FOR_EACH_TARGET(void, place_all,
                     (std::span<const RemovedGroup> groups, const TipInGrid& tip,
                      GroupSegments* out),
                     (groups, tip, out))

/// Volume and first moments: sufficient where all elements push in one direction.
struct Moments {
  Lanes volume, x, y, z;

  KERF_INLINE explicit Moments(const LaneSums& s) : volume(s.volume), x(s.x), y(s.y), z(s.z) {}
  KERF_INLINE void add(const GroupSegments& g) {
    volume = volume + g.length;
    x = x + g.length * g.middle.x;
    y = y + g.length * g.middle.y;
    z = z + g.length * g.middle.z;
  }
  KERF_INLINE void put(LaneSums& s) const {
    s.volume = volume;
    s.x = x;
    s.y = y;
    s.z = z;
  }
};

KERF_INLINE void add_moments_in_lanes(std::span<const GroupSegments> groups, LaneSums& sums) {
  Moments moments(sums);
  for (const GroupSegments& g : groups) moments.add(g);
  moments.put(sums);
}
/// Adds the moments of groups without weights.
KERF_INLINE void add_plain_moments_in_lanes(std::span<const RemovedGroup> groups,
                                            const TipInGrid& tip, LaneSums& sums) {
  Moments moments(sums);
  for (const RemovedGroup& g : groups) moments.add(placed(g, tip));
  moments.put(sums);
}

KERF_FOR_EACH_TARGET(void, add_moments, (std::span<const GroupSegments> groups, LaneSums& sums),
                     (groups, sums))
KERF_FOR_EACH_TARGET(void, add_plain_moments,
                     (std::span<const RemovedGroup> groups, const TipInGrid& tip, LaneSums& sums),
                     (groups, tip, sums))

/// Adds the pushes of elements whose displacements differ, and their moments about the pivot.
KERF_INLINE void add_pushes_in_lanes(std::span<const GroupSegments> groups, const Twist& twist,
                                     Vec3 pivot, LaneSums& sums) {
  const Vec3 v = twist.linear, w = twist.angular;
  LaneSums s = sums;
  for (const GroupSegments& g : groups) {
    const Lanes x = g.middle.x, z = g.middle.z;
    const double y = g.middle.y;
    const Lanes dx = v.x + (w.y * z - w.z * y);
    const Lanes dy = v.y + (w.z * x - w.x * z);
    const Lanes dz = v.z + (w.x * y - w.y * x);
    const Lanes across2 = dx * dx + dy * dy, along2 = dz * dz;
    const Lanes n = square_root(across2 + along2);
    const Lanes scale = select(n > 0.0, -g.length / n, Lanes{});
    const Lanes fx = dx * scale, fy = dy * scale, fz = dz * scale;
    const Lanes ax = x - pivot.x, az = z - pivot.z;
    const double ay = y - pivot.y;
    s.push_x = s.push_x + fx;
    s.push_y = s.push_y + fy;
    s.push_z = s.push_z + fz;
    s.turn_x = s.turn_x + ay * fz - az * fy;
    s.turn_y = s.turn_y + az * fx - ax * fz;
    s.turn_z = s.turn_z + ax * fy - ay * fx;
    s.across2 = s.across2 + g.length * across2;
    s.along2 = s.along2 + g.length * along2;
  }
  sums = s;
}
KERF_FOR_EACH_TARGET(void, add_pushes,
                     (std::span<const GroupSegments> groups, const Twist& twist, Vec3 pivot,
                      LaneSums& sums),
                     (groups, twist, pivot, sums))

KERF_INLINE Lanes& operator+=(Lanes& sum, const Lanes& more) { return sum = sum + more; }

KERF_INLINE void fold_in_lanes(const LaneSums& tile, LaneSums& sums) {
  sums.volume += tile.volume;
  sums.x += tile.x;
  sums.y += tile.y;
  sums.z += tile.z;
  sums.push_x += tile.push_x;
  sums.push_y += tile.push_y;
  sums.push_z += tile.push_z;
  sums.turn_x += tile.turn_x;
  sums.turn_y += tile.turn_y;
  sums.turn_z += tile.turn_z;
  sums.across2 += tile.across2;
  sums.along2 += tile.along2;
}
KERF_FOR_EACH_TARGET(void, fold, (const LaneSums& tile, LaneSums& sums), (tile, sums))

/// Inputs of the sums over a tile.
struct Summing {
  TipInGrid tip;
  const Twist& twist;
  const CutFrame& frame;
  const SurfaceWeight* weight;
  Vec3 pivot;
  bool common;  ///< all elements push in one direction
};

LaneSums sum_tile(std::span<const RemovedGroup> groups, const Summing& s) {
  LaneSums sums;
  if (s.weight == nullptr && s.common) {
    add_plain_moments(groups, s.tip, sums);
    return sums;
  }
  GroupSegments chunk[kChunk];
  for (std::size_t k = 0; k < groups.size(); k += kChunk) {
    const std::size_t count = std::min(kChunk, groups.size() - k);
    const std::span<GroupSegments> segments(chunk, count);
    place_all(groups.subspan(k, count), s.tip, chunk);
    if (s.weight != nullptr) s.weight->weigh(segments, s.frame.axis, s.frame.radius_mm);
    add_moments(segments, sums);
    if (!s.common) add_pushes(segments, s.twist, s.pivot, sums);
  }
  return sums;
}

/// Adds tile by tile, in tile order, so the sums do not depend on the number of parts.
LaneSums sum_parts(const Removal& removal, const Summing& s, Workers& workers) {
  const std::span<const RemovedPart> parts = removal.parts();
  LaneSums sums;
  if (parts.size() == 1) {
    for (std::size_t t = 0; t < parts[0].tiles.size(); ++t) fold(sum_tile(parts[0].of(t), s), sums);
    return sums;
  }
  std::vector<std::vector<LaneSums>> tiles(parts.size());
  workers.run(static_cast<int>(parts.size()), [&](int part) {
    const auto p = std::size_t(part);
    for (std::size_t t = 0; t < parts[p].tiles.size(); ++t) {
      tiles[p].push_back(sum_tile(parts[p].of(t), s));
    }
  });
  for (const std::vector<LaneSums>& part : tiles) {
    for (const LaneSums& tile : part) fold(tile, sums);
  }
  return sums;
}

}  // namespace

MovedSum sum_cut(const Removal& removal, const DexelGrid& grid, const Twist& twist,
                 const CutFrame& frame, const SurfaceWeight* weight, Workers& workers) {
  const double pitch = grid.pitch_mm, quantum = grid.z_quantum_mm;
  const Vec3 from_origin = frame.tip_mm - grid.origin_mm;
  const TipInGrid tip{from_origin.x / pitch - 0.5, from_origin.y / pitch - 0.5,
                      from_origin.z / quantum, pitch, quantum};
  const Vec3 pivot = frame.axis * frame.pivot_mm;
  const bool common =
      length(twist.angular) * frame.reach_mm <= kCommonDirectionShare * length(twist.linear);
  const LaneSums sums = sum_parts(removal, {tip, twist, frame, weight, pivot, common}, workers);
  const double area = pitch * pitch, volume = total(sums.volume);
  CutSum sum{volume * area, total(sums.x, sums.y, sums.z) * area, {}, {}};
  double across_mm = 0, along_mm = 0;
  if (common) {
    const Vec3 d = twist.at(sum.center_mm());
    const Vec3 push = -normalized(d);
    sum.push_mm3 = push * sum.volume_mm3;
    sum.turn_mm4 = cross(sum.moment_mm4 - pivot * sum.volume_mm3, push);
    across_mm = std::sqrt(d.x * d.x + d.y * d.y);
    along_mm = std::abs(d.z);
  } else {
    sum.push_mm3 = total(sums.push_x, sums.push_y, sums.push_z) * area;
    sum.turn_mm4 = total(sums.turn_x, sums.turn_y, sums.turn_z) * area;
    if (volume > 0) {
      across_mm = std::sqrt(total(sums.across2) / volume);
      along_mm = std::sqrt(total(sums.along2) / volume);
    }
  }
  sum.turn_mm4 = sum.turn_mm4 - frame.axis * dot(sum.turn_mm4, frame.axis);
  return {sum, across_mm, along_mm};
}

}  // namespace kerf
