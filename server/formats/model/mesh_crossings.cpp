// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/mesh_crossings.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "server/formats/model/triangle_pair.h"
#include "server/formats/stop_poll.h"

namespace kerf {
namespace {

struct Box {
  std::array<float, 3> low, high;
  void include(const Box& other) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], other.low[axis]);
      high[axis] = std::max(high[axis], other.high[axis]);
    }
  }
  bool meets(const Box& other) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (low[axis] > other.high[axis] || other.low[axis] > high[axis]) return false;
    }
    return true;
  }
  float doubled_middle(std::size_t axis) const { return low[axis] + high[axis]; }
};

/// Finds the pairs of triangles whose boxes meet.
class BoxTree {
 public:
  explicit BoxTree(std::vector<Box> boxes) : boxes_(std::move(boxes)), order_(boxes_.size()) {
    std::iota(order_.begin(), order_.end(), 0U);
    if (!order_.empty()) build(0, static_cast<std::uint32_t>(order_.size()));
  }
  /// Calls visit(n) for every triangle whose box meets that of `triangle`.
  template <class Visit>
  void for_near(std::uint32_t triangle, Visit&& visit) const {
    // Every level halves the range, so the depth is at most 32.
    std::array<std::uint32_t, 64> stack;
    std::size_t height = 0;
    stack[height++] = 0;
    while (height > 0) {
      const std::uint32_t number = stack[--height];
      const Node& node = nodes_[number];
      if (!node.box.meets(boxes_[triangle])) continue;
      for (std::uint32_t n = node.first; n < node.first + node.count; ++n) {
        if (boxes_[order_[n]].meets(boxes_[triangle])) visit(order_[n]);
      }
      if (node.count > 0) continue;
      stack[height++] = number + 1;
      stack[height++] = node.first;
    }
  }

 private:
  struct Node {
    Box box;
    std::uint32_t first, count;  ///< range of order_; count 0: inner node, first is its right child
  };
  static constexpr std::uint32_t kLeaf = 4;

  std::uint32_t build(std::uint32_t first, std::uint32_t end) {
    const auto number = static_cast<std::uint32_t>(nodes_.size());
    Node node{boxes_[order_[first]], first, end - first};
    for (std::uint32_t n = first; n < end; ++n) node.box.include(boxes_[order_[n]]);
    nodes_.push_back(node);
    if (end - first <= kLeaf) return number;
    std::size_t longest = 0;
    const auto length = [&](std::size_t axis) { return node.box.high[axis] - node.box.low[axis]; };
    for (std::size_t axis = 1; axis < 3; ++axis) {
      if (length(axis) > length(longest)) longest = axis;
    }
    const std::uint32_t half = first + (end - first) / 2;
    std::nth_element(order_.begin() + first, order_.begin() + half, order_.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) {
                       return boxes_[a].doubled_middle(longest) < boxes_[b].doubled_middle(longest);
                     });
    build(first, half);
    const std::uint32_t right = build(half, end);
    nodes_[number].first = right;
    nodes_[number].count = 0;
    return number;
  }

  std::vector<Box> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace

std::vector<std::uint32_t> crossing_triangles(const IndexedMesh& mesh,
                                              const std::stop_token& stop) {
  std::vector<FloatTriangle> corners;
  std::vector<Box> boxes;
  std::vector<bool> found(mesh.triangles.size()), flat(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const auto& p = mesh.positions_mm;
    corners.push_back({p[t[0]], p[t[1]], p[t[2]]});
    Box box{p[t[0]], p[t[0]]};
    for (const std::uint32_t v : t) box.include({p[v], p[v]});
    boxes.push_back(box);
    flat[corners.size() - 1] = found[corners.size() - 1] = has_no_area(corners.back());
  }
  const BoxTree tree(std::move(boxes));
  StopPoll poll(stop);
  for (std::uint32_t n = 0; n < corners.size() && !poll.stops(); ++n) {
    if (flat[n]) continue;
    tree.for_near(n, [&](std::uint32_t other) {
      if (other <= n || flat[other] || (found[n] && found[other])) return;
      if (do_cross(corners[n], corners[other])) found[n] = found[other] = true;
    });
  }
  std::vector<std::uint32_t> crossing;
  for (std::uint32_t n = 0; n < found.size(); ++n) {
    if (found[n]) crossing.push_back(n);
  }
  return crossing;
}

}  // namespace kerf
