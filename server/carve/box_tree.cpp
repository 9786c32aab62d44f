// SPDX-License-Identifier: Apache-2.0
#include "server/carve/box_tree.h"

namespace kerf {
namespace {

constexpr std::uint32_t kLeafMax = 4;

void enlarge(Box& box, const Box& by) {
  box.low = {std::min(box.low.x, by.low.x), std::min(box.low.y, by.low.y),
             std::min(box.low.z, by.low.z)};
  box.high = {std::max(box.high.x, by.high.x), std::max(box.high.y, by.high.y),
              std::max(box.high.z, by.high.z)};
}

}  // namespace

BoxTree::BoxTree(const std::vector<Box>& boxes) {
  for (std::uint32_t n = 0; n < boxes.size(); ++n) leaves_.push_back({boxes[n], n});
  if (!leaves_.empty()) build(0, static_cast<std::uint32_t>(leaves_.size()));
}

void BoxTree::build(std::uint32_t first, std::uint32_t end) {
  Box all = leaves_[first].box;
  for (std::uint32_t i = first; i < end; ++i) enlarge(all, leaves_[i].box);
  const std::size_t at = nodes_.size();
  nodes_.push_back({all, first, end - first});
  if (end - first <= kLeafMax) return;
  const Vec3 size = all.high - all.low;
  const auto middle_of = [&size](const Leaf& leaf) {
    const Vec3 twice = leaf.box.low + leaf.box.high;
    if (size.x >= size.y && size.x >= size.z) return twice.x;
    return size.y >= size.z ? twice.y : twice.z;
  };
  const std::uint32_t middle = first + (end - first) / 2;
  std::nth_element(leaves_.begin() + first, leaves_.begin() + middle, leaves_.begin() + end,
                   [&](const Leaf& a, const Leaf& b) {
                     const double ma = middle_of(a), mb = middle_of(b);
                     return ma != mb ? ma < mb : a.index < b.index;
                   });
  build(first, middle);
  nodes_[at].count = 0;
  nodes_[at].first = static_cast<std::uint32_t>(nodes_.size());
  build(middle, end);
}

}  // namespace kerf
