// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/guides/path_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

namespace kerf::agent {
namespace {

/// Number of segments in a leaf.
constexpr std::size_t kLeaf = 4;
/// Number of segments on either side of the last result at which a query begins.
constexpr std::size_t kBeside = 8;
/// More than the depth of a tree over kGuidePosesMax segments. Each level leaves one pending box.
constexpr std::size_t kDepthMax = 32;

double box_distance2(Vec3 p, Vec3 low, Vec3 high) noexcept {
  const auto outside = [](double v, double least, double most) {
    return v < least ? least - v : std::max(0.0, v - most);
  };
  const Vec3 d{outside(p.x, low.x, high.x), outside(p.y, low.y, high.y),
               outside(p.z, low.z, high.z)};
  return dot(d, d);
}

}  // namespace

PathTree::PathTree(const std::vector<GuidePath>& paths) {
  for (const GuidePath& path : paths) {
    if (path.size() == 1) segments_.push_back({path.front(), path.front()});
    for (std::size_t i = 1; i < path.size(); ++i) segments_.push_back({path[i - 1], path[i]});
  }
  const std::size_t leaves = std::bit_ceil((segments_.size() + kLeaf - 1) / kLeaf);
  boxes_.resize(2 * leaves - 1);
  build(0, 0, leaves * kLeaf);
}

/// Sets the boxes of `node`, which spans the segments from `first` to `end`, and of its children.
/// The number of segments is rounded up. A box without segments stays empty, infinitely far away.
PathTree::Box PathTree::build(std::size_t node, std::size_t first, std::size_t end) {
  constexpr double kFar = 1e300;
  Box box{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  const auto add = [&box](Vec3 low, Vec3 high) {
    box.min_mm = {std::min(box.min_mm.x, low.x), std::min(box.min_mm.y, low.y),
                  std::min(box.min_mm.z, low.z)};
    box.max_mm = {std::max(box.max_mm.x, high.x), std::max(box.max_mm.y, high.y),
                  std::max(box.max_mm.z, high.z)};
  };
  if (end - first > kLeaf) {
    const std::size_t middle = first + (end - first) / 2;
    for (const Box& child : {build(2 * node + 1, first, middle), build(2 * node + 2, middle, end)})
      add(child.min_mm, child.max_mm);
  } else {
    for (std::size_t i = first; i < std::min(end, segments_.size()); ++i) {
      add(segments_[i].from.tip_mm, segments_[i].from.tip_mm);
      add(segments_[i].to.tip_mm, segments_[i].to.tip_mm);
    }
  }
  return boxes_[node] = box;
}

void PathTree::examine(std::size_t segment, Vec3 tip_mm, Best& best) const noexcept {
  const Segment& s = segments_[segment];
  const Vec3 along = s.to.tip_mm - s.from.tip_mm;
  const double length2 = dot(along, along);
  const double share =
      length2 > 0 ? std::clamp(dot(tip_mm - s.from.tip_mm, along) / length2, 0.0, 1.0) : 0;
  const Vec3 apart = tip_mm - (s.from.tip_mm + along * share);
  const double distance2 = dot(apart, apart);
  if (distance2 < best.distance2) best = {segment, share, distance2};
}

/// Improves `best` depth first, the nearer child first.
void PathTree::search(Vec3 tip_mm, Best& best) noexcept {
  struct Pending {
    std::size_t node, first, end;
    double distance2;
  };
  std::array<Pending, kDepthMax> stack;
  std::size_t waiting = 0;
  const auto push = [&](std::size_t node, std::size_t first, std::size_t end) {
    ++visits_;
    const double d2 = box_distance2(tip_mm, boxes_[node].min_mm, boxes_[node].max_mm);
    if (d2 < best.distance2) stack[waiting++] = {node, first, end, d2};
  };
  push(0, 0, (boxes_.size() + 1) / 2 * kLeaf);
  while (waiting > 0 && visits_ < kMostVisits) {
    const Pending next = stack[--waiting];
    if (next.distance2 >= best.distance2) continue;
    if (next.end - next.first <= kLeaf) {
      for (std::size_t i = next.first; i < std::min(next.end, segments_.size()); ++i)
        examine(i, tip_mm, best);
      continue;
    }
    const std::size_t middle = next.first + (next.end - next.first) / 2;
    push(2 * next.node + 1, next.first, middle);
    push(2 * next.node + 2, middle, next.end);
    if (waiting >= 2 && stack[waiting - 2].distance2 < stack[waiting - 1].distance2 &&
        stack[waiting - 2].end == stack[waiting - 1].first) {
      std::swap(stack[waiting - 2], stack[waiting - 1]);
    }
  }
}

GuidePoint PathTree::point(const Best& best) const noexcept {
  const Segment& s = segments_[best.segment];
  const auto between = [&](Vec3 from, Vec3 to) { return from + (to - from) * best.share; };
  const Vec3 axis = between(s.from.axis, s.to.axis);
  const double axis_length = length(axis), along_mm = length(s.to.tip_mm - s.from.tip_mm);
  Vec3 rate{};
  if (best.share > 0 && best.share < 1 && axis_length > 0) {
    const Vec3 turned = (s.to.axis - s.from.axis) * (1 / (axis_length * along_mm));
    rate = turned - axis * (dot(axis, turned) / (axis_length * axis_length));
  }
  return {.tip_mm = between(s.from.tip_mm, s.to.tip_mm),
          .axis = axis_length > 0 ? normalized(axis) : s.from.axis,
          .tangent = normalized(s.to.tip_mm - s.from.tip_mm),
          .axis_rate = rate,
          .felt = s.from.felt + (s.to.felt - s.from.felt) * best.share,
          .distance_mm = std::sqrt(best.distance2)};
}

GuidePoint PathTree::nearest(Vec3 tip_mm) noexcept {
  visits_ = 0;
  Best best{.segment = last_, .share = 0, .distance2 = 1e300};
  const std::size_t first = last_ > kBeside ? last_ - kBeside : 0;
  for (std::size_t i = first; i < std::min(last_ + kBeside + 1, segments_.size()); ++i)
    examine(i, tip_mm, best);
  search(tip_mm, best);
  last_ = best.segment;
  return point(best);
}

}  // namespace kerf::agent
