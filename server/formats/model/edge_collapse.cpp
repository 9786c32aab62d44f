// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/edge_collapse.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "kernel/math/nearest_on_triangle.h"
#include "server/formats/model/collapsing_mesh.h"
#include "server/formats/model/quadric.h"
#include "server/formats/stop_poll.h"

namespace kerf {
namespace {

using Triangle = CollapsingMesh::Triangle;

constexpr std::uint32_t kNone = CollapsingMesh::kNone;
/// Share of the edges considered in a pass, the cheapest ones, because errors grow during a pass.
constexpr double kPassShare = 0.4;
/// Passes end when they collapse less than this share of the remaining vertices.
constexpr double kWorthwhileShare = 0.001;
/// Least cosine of the angle by which a collapse turns a triangle.
constexpr double kTurnCosineMin = 0.25;
/// Cosine of the angle of a turn that makes no fold.
constexpr double kSurelyFlatCosine = 0.8;
/// Greatest cosine of the angle between a triangle and one that is folded onto it.
constexpr double kFoldCosine = 0.9;
/// Cosine of the angle above which an edge is sharp: samples of the adjacent triangles are
/// unreliable there.
constexpr double kSharpCosine = 0.94;
/// Least height of a triangle as a share of its longest side, unless it was lower before.
constexpr double kHeightShareMin = 1e-3;
/// A removed vertex stays with its triangle while it is within this share of the limit.
constexpr double kStaysShare = 0.5;
/// An estimated distance of a triangle from the mesh is measured exactly above this share of the
/// limit.
constexpr double kEstimateShare = 0.75;

/// The move of a vertex to the other end of an edge.
struct Collapse {
  /// The number of the vertex and, in the upper bits, the cost to a quarter of a power of two.
  /// Vertices of similar cost are thus in the order of the mesh, in which neighbors are close in
  /// memory.
  std::uint64_t order;
  std::uint32_t to;

  Collapse(double cost_mm2, std::uint32_t from, std::uint32_t target)
      : order(std::uint64_t{std::bit_cast<std::uint32_t>(static_cast<float>(cost_mm2)) >> 21}
                  << 32 |
              from),
        to(target) {}
  std::uint32_t from() const { return static_cast<std::uint32_t>(order); }
  friend bool operator<(const Collapse& a, const Collapse& b) {
    return a.order != b.order ? a.order < b.order : a.to < b.to;
  }
};

class EdgeCollapser {
 public:
  EdgeCollapser(const IndexedMesh& mesh, const MeshNearest& nearest, const std::vector<bool>& kept,
                double error_mm)
      : mesh_(mesh),
        nearest_(nearest),
        kept_(kept),
        error_mm_(error_mm),
        error_mm2_(error_mm * error_mm),
        quadrics_(mesh.positions_mm.size()),
        locked_(mesh.positions_mm.size(), 0),
        seen_(mesh.positions_mm.size(), 0),
        a_triangle_(mesh.positions_mm.size(), 0) {
    if (error_mm < kNoCost) {
      away_mm_.assign(mesh.triangles.size(), 0);
      first_removed_.assign(mesh.triangles.size(), kNone);
      next_removed_.assign(mesh.positions_mm.size(), kNone);
    }
    normals_.reserve(mesh.triangles.size());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) add(t);
  }

  void run(std::size_t triangles, const std::stop_token& stop) {
    StopPoll poll(stop);
    while (mesh_.size() > triangles && !stop.stop_requested()) {
      collect();
      ++pass_;
      const std::size_t before = mesh_.size();
      for (const Collapse& collapse : candidates_) {
        if (mesh_.size() <= triangles || poll.stops()) break;
        if (is_allowed(collapse)) apply(collapse);
      }
      if (double(before - mesh_.size()) < kWorthwhileShare * double(before)) break;
    }
  }

  std::vector<Triangle> remaining() const { return mesh_.remaining(); }

 private:
  /// A triangle around the removed vertex, after the move.
  struct Moved {
    std::uint32_t triangle;
    std::size_t tip;  ///< the corner that moves
    double away_mm;   ///< from the mesh
    std::array<Vec3, 3> corners;
  };

  const Triangle& triangle(std::uint32_t t) const { return mesh_.triangles()[t]; }
  std::array<Vec3, 3> corners(std::uint32_t t) const { return mesh_.corners(triangle(t)); }

  void add(std::uint32_t t) {
    const auto [a, b, c] = corners(t);
    const Vec3 across = cross(b - a, c - a);
    const double twice_area = length(across);
    const Quadric plane =
        twice_area > 0 ? Quadric::of_plane(across * (1 / twice_area), a, twice_area) : Quadric{};
    const Vec3 n = across * (twice_area > 0 ? 1 / twice_area : 0);
    normals_.push_back({float(n.x), float(n.y), float(n.z)});
    for (const std::uint32_t v : triangle(t)) {
      quadrics_[v] += plane;
      a_triangle_[v] = t;
    }
  }

  // Collects the cheapest collapses of edges, in order.
  void collect() {
    candidates_.clear();
    for (const Triangle& t : mesh_.triangles()) {
      if (t[0] == kNone) continue;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = t[i], b = t[(i + 1) % 3];
        if (a > b) continue;  // the neighbor has the edge, too
        const double moved_a = kept_[a] ? kNoCost : quadrics_[a](mesh_.position(b));
        const double moved_b = kept_[b] ? kNoCost : quadrics_[b](mesh_.position(a));
        const double cost = std::min(moved_a, moved_b);
        if (!(cost <= error_mm2_) || cost == kNoCost) continue;
        candidates_.push_back(moved_a <= moved_b ? Collapse(cost, a, b) : Collapse(cost, b, a));
      }
    }
    const auto count = static_cast<std::ptrdiff_t>(kPassShare * double(candidates_.size()));
    const auto end =
        candidates_.begin() + std::min<std::ptrdiff_t>(std::max<std::ptrdiff_t>(count, kPassMin),
                                                       std::ptrdiff_t(candidates_.size()));
    if (end != candidates_.end()) std::nth_element(candidates_.begin(), end, candidates_.end());
    candidates_.erase(end, candidates_.end());
    std::sort(candidates_.begin(), candidates_.end());
  }

  bool is_allowed(const Collapse& collapse) {
    const std::uint32_t from = collapse.from(), to = collapse.to;
    if (locked_[from] == pass_ || locked_[to] == pass_) return false;
    return meets_link_condition(from, to) && keeps_shape(from, to) && finds_places(from, to) &&
           !folds(from, to) && stays_near(to);
  }

  bool meets_link_condition(std::uint32_t from, std::uint32_t to) {
    ++mark_;
    mesh_.for_around(to, [&](std::uint32_t t, std::uint32_t) {
      for (const std::uint32_t v : triangle(t)) seen_[v] = mark_;
    });
    seen_[to] = seen_[from] = 0;
    std::size_t common = 0;
    bool is_beside = false;
    around_.clear();
    mesh_.for_around(from, [&](std::uint32_t t, std::uint32_t i) {
      around_.push_back(t);
      const std::uint32_t next = triangle(t)[(i + 1) % 3], last = triangle(t)[(i + 2) % 3];
      common += seen_[next] == mark_ ? 1 : 0;
      is_beside |= seen_[next] == mark_ && seen_[last] == mark_;
    });
    return common == 2 && !(is_beside && has_triangle(to, from));
  }

  // Whether a triangle at `to` has the two vertices adjacent to both `to` and `from`. One of `from`
  // would then coincide with it, as in a tetrahedron.
  bool has_triangle(std::uint32_t to, std::uint32_t from) const {
    bool found = false;
    mesh_.for_around(to, [&](std::uint32_t t, std::uint32_t i) {
      const std::uint32_t next = triangle(t)[(i + 1) % 3], last = triangle(t)[(i + 2) % 3];
      if (next == from || last == from) return;
      found |= std::ranges::any_of(around_, [&](std::uint32_t other) {
        const Triangle& corners = triangle(other);
        return std::ranges::find(corners, next) != corners.end() &&
               std::ranges::find(corners, last) != corners.end();
      });
    });
    return found;
  }

  bool keeps_shape(std::uint32_t from, std::uint32_t to) {
    moved_.clear();
    for (const std::uint32_t t : around_) {
      const Triangle& before = triangle(t);
      if (std::ranges::find(before, to) != before.end()) continue;
      const auto tip = static_cast<std::size_t>(std::ranges::find(before, from) - before.begin());
      Moved moved{t, tip, away_mm_.empty() ? 0 : away_mm_[t], corners(t)};
      moved.corners[tip] = mesh_.position(to);
      if (!keeps_shape(corners(t), moved.corners, mesh_normal(t))) return false;
      moved_.push_back(moved);
    }
    return !moved_.empty();
  }

  static double squared_height_share(const std::array<Vec3, 3>& t) {
    const Vec3 ab = t[1] - t[0], bc = t[2] - t[1], ca = t[0] - t[2], across = cross(ab, bc);
    const double longest = std::max({dot(ab, ab), dot(bc, bc), dot(ca, ca)});
    return dot(across, across) / (longest * longest);
  }

  static bool keeps_shape(const std::array<Vec3, 3>& before, const std::array<Vec3, 3>& after,
                          Vec3 normal) {
    const Vec3 is = normal_of(after);
    const double is2 = dot(is, is), along = dot(is, normal);
    if (!(along > 0 && along * along > kTurnCosineMin * kTurnCosineMin * is2)) return false;
    const double share2 = squared_height_share(after);
    return share2 >= kHeightShareMin * kHeightShareMin || share2 > squared_height_share(before);
  }

  // Whether a triangle that has turned far would fold onto one with which it shares an edge.
  bool folds(std::uint32_t from, std::uint32_t to) const {
    return std::ranges::any_of(moved_, [&](const Moved& moved) {
      const Vec3 normal = normal_of(moved.corners);
      const double along = dot(normal, mesh_normal(moved.triangle));
      if (along * along > kSurelyFlatCosine * kSurelyFlatCosine * dot(normal, normal)) return false;
      const Triangle after = replaced(triangle(moved.triangle), from, to);
      bool found = false;
      for (const std::uint32_t v : after) {
        if (v == to) continue;
        mesh_.for_around(v, [&](std::uint32_t t, std::uint32_t) {
          const Triangle other = replaced(triangle(t), from, to);
          if (t == moved.triangle || common_corners(after, other) != 2) return;
          const Vec3 n = normal_of(mesh_.corners(other));
          const double both = dot(n, normal);
          found |=
              both < 0 && both * both > kFoldCosine * kFoldCosine * dot(n, n) * dot(normal, normal);
        });
      }
      return found;
    });
  }

  static Triangle replaced(Triangle t, std::uint32_t from, std::uint32_t to) {
    std::ranges::replace(t, from, to);
    return t;
  }
  static int common_corners(const Triangle& a, const Triangle& b) {
    int common = 0;
    for (const std::uint32_t v : a) common += std::ranges::find(b, v) != b.end() ? 1 : 0;
    return common;
  }
  static Vec3 normal_of(const std::array<Vec3, 3>& t) { return cross(t[1] - t[0], t[2] - t[0]); }
  Vec3 mesh_normal(std::uint32_t t) const {
    const auto [x, y, z] = normals_[t];
    return {double(x), double(y), double(z)};
  }

  // Finds the triangles that the vertex, and those removed before, belong to after the collapse.
  bool finds_places(std::uint32_t from, std::uint32_t to) {
    if (first_removed_.empty()) return true;
    placed_.clear();
    if (!finds_place(from, kNone)) return false;
    for (const std::uint32_t t : around_) {
      const bool stays = std::ranges::find(triangle(t), to) == triangle(t).end();
      for (std::uint32_t v = first_removed_[t]; v != kNone; v = next_removed_[v])
        if (!finds_place(v, stays ? t : kNone)) return false;
    }
    return true;
  }

  bool finds_place(std::uint32_t vertex, std::uint32_t usual) {
    const Vec3 point = mesh_.position(vertex);
    const auto squared = [&](const Moved& moved) {
      const Vec3 away = point - nearest_on_triangle(moved.corners, point).point;
      return dot(away, away);
    };
    double nearest = error_mm2_;
    std::uint32_t place = kNone;
    if (usual != kNone) {
      const double d = squared(*std::ranges::find(moved_, usual, &Moved::triangle));
      if (d <= nearest) nearest = d, place = usual;
    }
    if (nearest > kStaysShare * kStaysShare * error_mm2_ || place == kNone) {
      for (const Moved& moved : moved_) {
        const double d = squared(moved);
        if (d < nearest || (d == nearest && place == kNone)) nearest = d, place = moved.triangle;
      }
    }
    placed_.push_back({vertex, place});
    return place != kNone;
  }

  // Whether the midpoints of the new triangles and of their new edges are near the mesh.
  bool stays_near(std::uint32_t to) {
    if (first_removed_.empty()) return true;
    std::uint32_t near = a_triangle_[to];
    for (Moved& moved : moved_) {
      const auto& [a, b, c] = moved.corners;
      const double inside = estimated_mm((a + b + c) * (1.0 / 3), moved.triangle, near);
      if (inside > error_mm_) return false;
      moved.away_mm = std::max(moved.away_mm, inside);
      const std::size_t next = (moved.tip + 1) % 3;
      const Vec3 middle = (moved.corners[moved.tip] + moved.corners[next]) * 0.5;
      Moved* const beside = beside_edge(triangle(moved.triangle)[next]);
      if (beside == nullptr) continue;
      const double edge = is_sharp(moved, *beside) ? measured_mm(middle, near)
                                                   : estimated_mm(middle, moved.triangle, near);
      if (edge > error_mm_) return false;
      moved.away_mm = std::max(moved.away_mm, edge);
      beside->away_mm = std::max(beside->away_mm, edge);
    }
    return true;
  }

  // The triangle whose edge to the tip begins at a vertex, or nullptr if that edge existed before.
  Moved* beside_edge(std::uint32_t vertex) {
    for (Moved& moved : moved_)
      if (triangle(moved.triangle)[(moved.tip + 2) % 3] == vertex) return &moved;
    return nullptr;
  }

  static bool is_sharp(const Moved& a, const Moved& b) {
    const Vec3 n = normal_of(a.corners), m = normal_of(b.corners);
    const double along = dot(n, m);
    return along < 0 || along * along < kSharpCosine * kSharpCosine * dot(n, n) * dot(m, m);
  }

  // Estimates the distance of a point from the mesh by the replaced triangles, whose own distances
  // are known. Measures it if the estimate is too large.
  double estimated_mm(Vec3 point, std::uint32_t usual, std::uint32_t& near) {
    double least = kNoCost;
    const auto try_triangle = [&](std::uint32_t t) {
      const Vec3 away = point - nearest_on_triangle(corners(t), point).point;
      least = std::min(least, length(away) + away_mm_[t]);
    };
    try_triangle(usual);
    for (std::size_t i = 0; i < around_.size() && least > kStaysShare * error_mm_; ++i)
      try_triangle(around_[i]);
    return least <= kEstimateShare * error_mm_ ? least : measured_mm(point, near);
  }

  double measured_mm(Vec3 point, std::uint32_t& near) const {
    const auto found = nearest_.find(point, near, kStaysShare * kStaysShare * error_mm2_);
    near = found.triangle;
    return std::sqrt(found.squared_mm2);
  }

  void apply(const Collapse& collapse) {
    const std::uint32_t from = collapse.from(), to = collapse.to;
    locked_[from] = locked_[to] = pass_;
    quadrics_[to] += quadrics_[from];
    mesh_.collapse(from, to, around_);
    if (!first_removed_.empty())
      for (const std::uint32_t t : around_) first_removed_[t] = kNone;
    if (!away_mm_.empty())
      for (const Moved& moved : moved_) away_mm_[moved.triangle] = moved.away_mm;
    for (const auto& [vertex, place] : placed_) {
      next_removed_[vertex] = first_removed_[place];
      first_removed_[place] = vertex;
    }
  }

  struct Placed {
    std::uint32_t vertex, triangle;
  };
  static constexpr double kNoCost = std::numeric_limits<double>::infinity();
  static constexpr std::ptrdiff_t kPassMin = 1000;

  CollapsingMesh mesh_;
  const MeshNearest& nearest_;
  const std::vector<bool>& kept_;
  const double error_mm_, error_mm2_;
  std::vector<Quadric> quadrics_;
  std::vector<std::uint32_t> first_removed_, next_removed_;  ///< lists of removed vertices, by
                                                             ///< triangle; empty without a limit
  std::vector<std::uint32_t> locked_;  ///< last pass in which an edge of the vertex collapsed
  std::vector<std::array<float, 3>> normals_;  ///< of the triangles, as in the mesh
  std::vector<double> away_mm_;  ///< distance of each triangle from the mesh; empty without a limit
  std::vector<std::uint32_t> seen_;
  std::vector<std::uint32_t> a_triangle_;  ///< a triangle of the mesh at each vertex
  std::uint32_t mark_ = 0, pass_ = 0;
  std::vector<Collapse> candidates_;
  // State of the examined collapse:
  std::vector<std::uint32_t> around_;
  std::vector<Moved> moved_;
  std::vector<Placed> placed_;
};

}  // namespace

std::vector<Triangle> collapse_edges(const IndexedMesh& mesh, const MeshNearest& nearest,
                                     const std::vector<bool>& kept, const CollapseLimits& limits,
                                     const std::stop_token& stop) {
  EdgeCollapser collapser(mesh, nearest, kept, limits.error_mm);
  collapser.run(limits.triangles, stop);
  return collapser.remaining();
}

}  // namespace kerf
