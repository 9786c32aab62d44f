// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/simplify_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "server/formats/model/edge_collapse.h"
#include "server/formats/model/mesh_crossings.h"
#include "server/formats/model/mesh_nearest.h"
#include "server/formats/number_text.h"
#include "server/formats/stop_poll.h"

namespace kerf {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// Attempts to collapse without the cause of the last failure. Each keeps a larger neighborhood.
constexpr int kAttemptsMax = 20;
/// Attempts to halve the error if only the number of triangles is given.
constexpr int kHalvingsMax = 2;
/// Edges are collapsed within this share of the bound, because only samples are checked.
constexpr double kCollapseShare = 0.95;
constexpr double kNoBound = std::numeric_limits<double>::infinity();

/// Collapses edges, checks the result, and repeats without the collapses that made it invalid.
class Simplifier {
 public:
  Simplifier(const IndexedMesh& exact, const ModelProgress& progress, const std::stop_token& stop)
      : exact_(exact),
        progress_(progress),
        stop_(stop),
        to_exact_(exact),
        kept_(exact.positions_mm.size(), false) {}

  std::expected<SimplifiedMesh, ModelError> run(const SimplifyRequest& request) {
    const std::size_t target = request.triangles.value_or(0);
    auto simplified = request.error_mm ? attempt(target, *request.error_mm) : reduce(target);
    if (stop_.stop_requested()) return std::unexpected(ModelError{"stopped"});
    if (simplified) return *std::move(simplified);
    if (request.error_mm) return SimplifiedMesh{exact_, 0, 0, 0};
    return std::unexpected(
        ModelError{"the surface cannot be simplified that far and stay a closed manifold"});
  }

 private:
  /// Returns a surface within a number of triangles, with the smallest error that a few attempts
  /// find.
  std::optional<SimplifiedMesh> reduce(std::size_t target) {
    auto best = attempt(target, kNoBound);
    if (!best && crossed_) crossed_->error_mm = measure(crossed_->mesh, kNoBound).error_mm;
    if (!best) return std::move(crossed_);
    for (int n = 0; n < kHalvingsMax; ++n) {
      auto better = attempt(target, best->error_mm / 2);
      if (!better || better->mesh.triangles.size() > target) break;
      best = std::move(better);
    }
    return best;
  }

  /// Returns a valid surface within a bound, with `target` triangles, or more if the bound
  /// requires it. Empty after too many attempts, if a stop was requested, or, without a bound, if
  /// all small enough results have crossings.
  std::optional<SimplifiedMesh> attempt(std::size_t target, double bound_mm) {
    for (int n = 0; n < kAttemptsMax; ++n) {
      if (progress_) progress_(n / double(kAttemptsMax));
      const IndexedMesh result{
          exact_.origin_mm, exact_.positions_mm,
          collapse_edges(exact_, to_exact_, kept_, {target, kCollapseShare * bound_mm}, stop_)};
      if (stop_.stop_requested()) return {};
      const Faults faults = find_faults(result);
      // The parts kept around crossings exceed the number of triangles.
      if (crossed_ && bound_mm == kNoBound && result.triangles.size() > target) return {};
      Measured measured;
      if (faults.none()) measured = measure(result, bound_mm);
      if (stop_.stop_requested()) return {};
      if (faults.none() && measured.error_mm <= bound_mm)
        return SimplifiedMesh{compact(result), 0, measured.error_mm, 0};
      if (faults.closed && bound_mm == kNoBound &&
          (!crossed_ || faults.crossing.size() < crossed_->crossing_triangles))
        crossed_ = SimplifiedMesh{compact(result), 0, 0, faults.crossing.size()};
      keep_around(result, faults, measured.beyond, 1 + n / 4);
    }
    return {};
  }

  /// Faults that make a result invalid.
  struct Faults {
    bool closed = false;                  ///< a closed manifold with triangles
    std::vector<std::uint32_t> at_edges;  ///< vertices where it is not
    std::vector<std::uint32_t> crossing;  ///< triangles; not searched if the result is not closed
    bool none() const { return closed && crossing.empty(); }
  };
  Faults find_faults(const IndexedMesh& result) const {
    EdgeReport edges = check_edges(result.triangles);
    Faults faults{
        edges.closed_manifold() && !result.triangles.empty(), std::move(edges.vertices), {}};
    if (faults.closed) faults.crossing = crossing_triangles(result, stop_);
    return faults;
  }

  /// Keeps the exact surface around faults and the vertices beyond a bound.
  void keep_around(const IndexedMesh& result, const Faults& faults,
                   const std::vector<std::uint32_t>& beyond, int rings) {
    std::vector<bool> spoilt(kept_.size(), false);
    for (const std::uint32_t v : faults.at_edges) spoilt[v] = true;
    for (const std::uint32_t t : faults.crossing) {
      for (const std::uint32_t v : result.triangles[t]) spoilt[v] = true;
    }
    for (const std::uint32_t v : beyond) spoilt[v] = true;
    for (int ring = 0; ring < rings; ++ring) grow(spoilt);
    for (std::size_t v = 0; v < kept_.size(); ++v) kept_[v] = kept_[v] || spoilt[v];
  }

  void grow(std::vector<bool>& vertices) const {
    const std::vector<bool> before = vertices;
    for (const Triangle& t : exact_.triangles) {
      if (before[t[0]] || before[t[1]] || before[t[2]]) {
        for (const std::uint32_t v : t) vertices[v] = true;
      }
    }
  }

  struct Measured {
    double error_mm = 0;                ///< greatest distance between the two surfaces
    std::vector<std::uint32_t> beyond;  ///< vertices next to which it exceeds the bound
  };
  Measured measure(const IndexedMesh& result, double bound_mm) const {
    Measured measured;
    // Returns the distance of a point from a mesh, or any smaller bound that does not change the
    // result: most points are nearer than the greatest distance so far, and the search can end
    // early.
    const auto distance_mm = [&](const MeshNearest& mesh, Vec3 point, std::uint32_t& near) {
      const double enough_mm = std::min(measured.error_mm, bound_mm);
      const auto found = mesh.find(point, near, enough_mm * enough_mm);
      near = found.triangle;
      return std::sqrt(found.squared_mm2);
    };
    const MeshNearest to_result(result);
    StopPoll poll(stop_);
    std::uint32_t near = 0;
    for (std::uint32_t v = 0; v < exact_.positions_mm.size() && !poll.stops(); ++v) {
      const double d = distance_mm(to_result, exact_.position(v), near);
      measured.error_mm = std::max(measured.error_mm, d);
      if (d > bound_mm) measured.beyond.push_back(v);
    }
    near = 0;
    for (std::size_t t = 0; t < result.triangles.size() && !poll.stops(); ++t) {
      const auto [a, b, c] = result.corners(t);
      for (const Vec3 p : {(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5, (a + b + c) * (1.0 / 3)}) {
        const double d = distance_mm(to_exact_, p, near);
        measured.error_mm = std::max(measured.error_mm, d);
        if (d <= bound_mm) continue;
        const auto &around = exact_.triangles[near], &ends = result.triangles[t];
        measured.beyond.insert(measured.beyond.end(), around.begin(), around.end());
        measured.beyond.insert(measured.beyond.end(), ends.begin(), ends.end());
      }
    }
    return measured;
  }

  /// Drops unused vertices.
  static IndexedMesh compact(const IndexedMesh& mesh) {
    IndexedMesh out{mesh.origin_mm, {}, mesh.triangles};
    std::vector<std::uint32_t> number(mesh.positions_mm.size(), UINT32_MAX);
    for (Triangle& t : out.triangles) {
      for (std::uint32_t& v : t) {
        if (number[v] == UINT32_MAX) {
          number[v] = static_cast<std::uint32_t>(out.positions_mm.size());
          out.positions_mm.push_back(mesh.positions_mm[v]);
        }
        v = number[v];
      }
    }
    return out;
  }

  const IndexedMesh& exact_;
  const ModelProgress& progress_;
  const std::stop_token& stop_;
  const MeshNearest to_exact_;
  std::vector<bool> kept_;                 ///< vertices of the exact mesh that stay
  std::optional<SimplifiedMesh> crossed_;  ///< the result with the fewest crossing triangles
};

std::unexpected<ModelError> budget_missed(const SimplifyRequest& request, std::size_t reached) {
  const std::string bound =
      request.error_mm ? " within " + significant_text(*request.error_mm, 6) + " mm" : "";
  return std::unexpected(ModelError{"the surface needs " + std::to_string(reached) + " triangles" +
                                    bound + ", more than the " +
                                    std::to_string(*request.triangles) + " requested"});
}

}  // namespace

std::expected<SimplifiedMesh, ModelError> simplify_mesh(MeshSource& source,
                                                        const SimplifyRequest& request,
                                                        const ModelProgress& progress,
                                                        const std::stop_token& stop) {
  const IndexedMesh exact = collect_mesh(source, stop);
  if (stop.stop_requested()) return std::unexpected(ModelError{"stopped"});
  if (exact.triangles.empty()) return SimplifiedMesh{exact, 0, 0, 0};
  auto simplified = Simplifier(exact, progress, stop).run(request);
  if (!simplified) return simplified;
  simplified->original_triangles = exact.triangles.size();
  if (request.triangles && simplified->mesh.triangles.size() > *request.triangles) {
    return budget_missed(request, simplified->mesh.triangles.size());
  }
  if (progress) progress(1);
  return simplified;
}

}  // namespace kerf
