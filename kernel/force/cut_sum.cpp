// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/cut_sum.h"

#include <algorithm>
#include <array>
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

double lanes_total(const Lanes& lanes) {
  double sum = 0;
  for (int c = 0; c < kLanes; ++c) sum += lanes[c];
  return sum;
}
Vec3 lanes_total(const Lanes& x, const Lanes& y, const Lanes& z) {
  return {lanes_total(x), lanes_total(y), lanes_total(z)};
}

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

/// Volume and first moments, which suffice if all elements push in one direction.
struct Moments {
  Lanes volume, x, y, z;

  KERF_INLINE explicit Moments(const TileSum& s) : volume(s.volume), x(s.x), y(s.y), z(s.z) {}
  KERF_INLINE void add(const GroupSegments& g) {
    volume = volume + g.length;
    x = x + g.length * g.middle.x;
    y = y + g.length * g.middle.y;
    z = z + g.length * g.middle.z;
  }
  KERF_INLINE void put(TileSum& s) const {
    s.volume = volume;
    s.x = x;
    s.y = y;
    s.z = z;
  }
};

KERF_INLINE void add_moments_in_lanes(std::span<const GroupSegments> groups, TileSum& sums) {
  Moments moments(sums);
  for (const GroupSegments& g : groups) moments.add(g);
  moments.put(sums);
}
/// Adds the moments of groups without weights.
KERF_INLINE void add_plain_moments_in_lanes(std::span<const RemovedGroup> groups,
                                            const TipInGrid& tip, TileSum& sums) {
  Moments moments(sums);
  for (const RemovedGroup& g : groups) moments.add(placed(g, tip));
  moments.put(sums);
}

KERF_FOR_EACH_TARGET(void, add_moments, (std::span<const GroupSegments> groups, TileSum& sums),
                     (groups, sums))
KERF_FOR_EACH_TARGET(void, add_plain_moments,
                     (std::span<const RemovedGroup> groups, const TipInGrid& tip, TileSum& sums),
                     (groups, tip, sums))

/// Adds the pushes of elements whose displacements differ, and their moments about the pivot.
KERF_INLINE void add_pushes_in_lanes(std::span<const GroupSegments> groups, const Twist& twist,
                                     Vec3 pivot, TileSum& sums) {
  const Vec3 v = twist.linear, w = twist.angular;
  TileSum s = sums;
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
                      TileSum& sums),
                     (groups, twist, pivot, sums))

KERF_INLINE Lanes& operator+=(Lanes& sum, const Lanes& more) { return sum = sum + more; }

KERF_INLINE void fold_in_lanes(const TileSum& tile, TileSum& sums) {
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
KERF_FOR_EACH_TARGET(void, fold, (const TileSum& tile, TileSum& sums), (tile, sums))

/// Multiplies the lengths of segments by the shares of their columns.
void count_by_share(std::span<const RemovedGroup> groups, const ColumnShares& shares,
                    GroupSegments* segments) {
  std::array<double, kLanes> of{};
  for (std::size_t k = 0; k < groups.size(); ++k) {
    if (!shares.of_group(groups[k].i, groups[k].j, of)) continue;
    Lanes& length = segments[k].length;
    for (int c = 0; c < kLanes; ++c) length.set(c, length[c] * of[std::size_t(c)]);
  }
}

}  // namespace

void TileSum::add(const TileSum& tile) { fold(tile, *this); }

CutSummer::CutSummer(const DexelGrid& grid, const Twist& twist, const CutFrame& frame,
                     const SurfaceWeight* weight, const ColumnShares* shares)
    : twist_(twist),
      frame_(frame),
      weight_(weight),
      shares_(shares),
      pivot_(frame.axis * frame.pivot_mm),
      common_(length(twist.angular) * frame.reach_mm <=
              kCommonDirectionShare * length(twist.linear)) {
  const double pitch = grid.pitch_mm, quantum = grid.z_quantum_mm;
  const Vec3 from_origin = frame.tip_mm - grid.origin_mm;
  tip_ = {from_origin.x / pitch - 0.5, from_origin.y / pitch - 0.5, from_origin.z / quantum, pitch,
          quantum};
}

TileSum CutSummer::sum(std::span<const RemovedGroup> groups) const {
  TileSum sums;
  const bool border =
      shares_ != nullptr && !groups.empty() && !shares_->are_whole(tile_of(groups.front()));
  if (weight_ == nullptr && common_ && !border) {
    add_plain_moments(groups, tip_, sums);
    return sums;
  }
  GroupSegments chunk[kChunk];
  for (std::size_t k = 0; k < groups.size(); k += kChunk) {
    const std::size_t count = std::min(kChunk, groups.size() - k);
    const std::span<GroupSegments> segments(chunk, count);
    place_all(groups.subspan(k, count), tip_, chunk);
    if (weight_ != nullptr) weight_->weigh(segments, frame_.axis, frame_.radius_mm);
    if (border) count_by_share(groups.subspan(k, count), *shares_, chunk);
    add_moments(segments, sums);
    if (!common_) add_pushes(segments, twist_, pivot_, sums);
  }
  return sums;
}

MovedSum CutSummer::total(const TileSum& sums) const {
  const double pitch = tip_.pitch_mm;
  const double area = pitch * pitch, volume = lanes_total(sums.volume);
  CutSum sum{volume * area, lanes_total(sums.x, sums.y, sums.z) * area, {}, {}};
  double across_mm = 0, along_mm = 0;
  if (common_) {
    const Vec3 d = twist_.at(sum.center_mm());
    const Vec3 push = -normalized(d);
    sum.push_mm3 = push * sum.volume_mm3;
    sum.turn_mm4 = cross(sum.moment_mm4 - pivot_ * sum.volume_mm3, push);
    across_mm = std::sqrt(d.x * d.x + d.y * d.y);
    along_mm = std::abs(d.z);
  } else {
    sum.push_mm3 = lanes_total(sums.push_x, sums.push_y, sums.push_z) * area;
    sum.turn_mm4 = lanes_total(sums.turn_x, sums.turn_y, sums.turn_z) * area;
    if (volume > 0) {
      across_mm = std::sqrt(lanes_total(sums.across2) / volume);
      along_mm = std::sqrt(lanes_total(sums.along2) / volume);
    }
  }
  sum.turn_mm4 = sum.turn_mm4 - frame_.axis * dot(sum.turn_mm4, frame_.axis);
  return {sum, across_mm, along_mm};
}

}  // namespace kerf
