// SPDX-License-Identifier: Apache-2.0
#include "server/verify/box_tree.h"

#include <utility>

namespace kerf {
namespace {

constexpr std::uint32_t kRunsMax = 4;

}  // namespace

Box around(const Box& a, const Box& b) {
  return {
      {std::min(a.low.x, b.low.x), std::min(a.low.y, b.low.y), std::min(a.low.z, b.low.z)},
      {std::max(a.high.x, b.high.x), std::max(a.high.y, b.high.y), std::max(a.high.z, b.high.z)}};
}

BoxTree::BoxTree(std::vector<Box> boxes, std::uint32_t run) : boxes_(std::move(boxes)) {
  const auto count = static_cast<std::uint32_t>(boxes_.size());
  for (std::uint32_t n = 0; n < count; n += run) {
    Run& made = runs_.emplace_back(boxes_[n], n, std::min(n + run, count));
    for (std::uint32_t i = n; i < made.end; ++i) made.box = around(made.box, boxes_[i]);
  }
  if (!runs_.empty()) build(0, static_cast<std::uint32_t>(runs_.size()));
}

void BoxTree::build(std::uint32_t first, std::uint32_t end) {
  Box all = runs_[first].box;
  for (std::uint32_t i = first; i < end; ++i) all = around(all, runs_[i].box);
  const std::size_t at = nodes_.size();
  nodes_.push_back({all, first, end - first});
  if (end - first <= kRunsMax) return;
  const Vec3 size = all.high - all.low;
  const auto middle_of = [&size](const Run& leaf) {
    const Vec3 twice = leaf.box.low + leaf.box.high;
    if (size.x >= size.y && size.x >= size.z) return twice.x;
    return size.y >= size.z ? twice.y : twice.z;
  };
  const std::uint32_t middle = first + (end - first) / 2;
  std::nth_element(runs_.begin() + first, runs_.begin() + middle, runs_.begin() + end,
                   [&](const Run& a, const Run& b) {
                     const double ma = middle_of(a), mb = middle_of(b);
                     return ma != mb ? ma < mb : a.first < b.first;
                   });
  build(first, middle);
  nodes_[at].count = 0;
  nodes_[at].first = static_cast<std::uint32_t>(nodes_.size());
  build(middle, end);
}

}  // namespace kerf
