// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/simplify_mesh.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "server/formats/model/mesh_crossings.h"
#include "server/formats/model/mesh_nearest.h"
#include "server/formats/number_text.h"

namespace kerf {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
using Triangles = std::vector<Triangle>;

/// Rounds that protect the surroundings of invalid collapses; each protects a larger neighborhood.
constexpr int kRoundsMax = 20;
/// Rounds that reduce collapsing at the worst places if only the number of triangles is given.
constexpr int kBudgetRounds = 6;
/// If a larger fraction of the vertices exceeds the bound, collapsing is reduced everywhere.
constexpr double kSpoiltShareMax = 0.002;
/// Lower limit of that reduction, as a fraction of the bound: rough surfaces have such places
/// everywhere.
constexpr double kEstimateShareMin = 0.05;
constexpr double kNoBound = std::numeric_limits<double>::infinity();

/// Drops pairs of coincident triangles of opposite orientation, which enclose nothing; the surface
/// stays closed.
void cancel_opposites(Triangles& triangles) {
  const auto key = [](const Triangle& t) {
    Triangle sorted = t;
    std::ranges::sort(sorted);
    return sorted;
  };
  const auto turns_up = [](const Triangle& t) {  // an even permutation of its sorted corners
    const int swaps = (t[0] > t[1] ? 1 : 0) + (t[0] > t[2] ? 1 : 0) + (t[1] > t[2] ? 1 : 0);
    return swaps % 2 == 0;
  };
  std::ranges::stable_sort(triangles, {}, key);
  Triangles kept;
  for (std::size_t first = 0; first < triangles.size();) {
    Triangles up, down;
    const Triangle same = key(triangles[first]);
    for (; first < triangles.size() && key(triangles[first]) == same; ++first) {
      (turns_up(triangles[first]) ? up : down).push_back(triangles[first]);
    }
    const std::size_t pairs = std::min(up.size(), down.size());
    kept.insert(kept.end(), up.begin() + std::ptrdiff_t(pairs), up.end());
    kept.insert(kept.end(), down.begin() + std::ptrdiff_t(pairs), down.end());
  }
  triangles = std::move(kept);
}

/// Collapses edges, checks the result, and repeats without the collapses that made it invalid.
class Simplifier {
 public:
  explicit Simplifier(const IndexedMesh& exact)
      : exact_(exact), to_exact_(exact), kept_(exact.positions_mm.size(), false) {
    scale_ = static_cast<double>(meshopt_simplifyScale(exact.positions_mm.front().data(),
                                                       exact.positions_mm.size(),
                                                       sizeof(exact.positions_mm.front())));
  }

  std::expected<SimplifiedMesh, ModelError> run(const SimplifyRequest& request,
                                                const ModelProgress& progress,
                                                const std::stop_token& stop) {
    // meshoptimizer asserts that the target is not above the number that there are.
    const std::size_t target =
        std::min<std::size_t>(request.triangles.value_or(0), exact_.triangles.size());
    // Without a bound, collapsing is reduced at the worst places as long as the error decreases.
    double bound_mm = request.error_mm.value_or(kNoBound);
    double estimate_mm =
        bound_mm;  // limit of meshoptimizer's estimate, which is a mean and not a maximum
    std::optional<SimplifiedMesh> best, crossed;
    int rounds = request.error_mm ? kRoundsMax : kBudgetRounds;
    for (int round = 0; round < rounds; ++round) {
      if (stop.stop_requested()) return std::unexpected(ModelError{"stopped"});
      if (progress) progress(round / double(rounds));
      const IndexedMesh result{exact_.origin_mm, exact_.positions_mm,
                               collapse(target, estimate_mm)};
      const Faults faults = find_faults(result);
      const bool within = request.triangles.value_or(SIZE_MAX) >= result.triangles.size();
      if (faults.closed && !faults.none() && within && !request.error_mm &&
          (!crossed || faults.crossing.size() < crossed->crossing_triangles)) {
        crossed = SimplifiedMesh{compact(result), 0, 0, faults.crossing.size()};
      }
      if (crossed && !within) break;  // what is kept exceeds the number of triangles
      // Otherwise only the places beyond a bound count.
      Measured measured;
      if (faults.none() || bound_mm < kNoBound || result.triangles.empty()) {
        measured = measure(result, bound_mm);
      }
      if (faults.none() && request.error_mm && measured.error_mm <= bound_mm)
        return SimplifiedMesh{compact(result), 0, measured.error_mm, 0};
      if (faults.none() && !request.error_mm && (within || !best)) {
        if (!best || measured.error_mm < best->error_mm)
          best = SimplifiedMesh{compact(result), 0, measured.error_mm, 0};
        bound_mm = measured.error_mm / 2;
        measured = measure(result, bound_mm);
      } else if (!faults.none()) {
        rounds = kRoundsMax;
      }
      const double spoilt_share =
          static_cast<double>(measured.beyond.size()) / static_cast<double>(kept_.size());
      if (best && spoilt_share > kSpoiltShareMax) break;
      if (spoilt_share > kSpoiltShareMax && estimate_mm > bound_mm * kEstimateShareMin) {
        estimate_mm /= 2;
        continue;
      }
      keep_around(result, faults, measured.beyond, 1 + round / 4);
    }
    if (best) return *std::move(best);
    if (crossed) {
      crossed->error_mm = measure(crossed->mesh, kNoBound).error_mm;
      return *std::move(crossed);
    }
    if (request.error_mm) return SimplifiedMesh{exact_, 0, 0, 0};
    return std::unexpected(
        ModelError{"the surface cannot be simplified that far and stay a closed manifold"});
  }

 private:
  /// What makes a result invalid.
  struct Faults {
    bool closed = false;                  ///< a closed manifold with triangles
    std::vector<std::uint32_t> at_edges;  ///< vertices where it is none
    std::vector<std::uint32_t> crossing;  ///< triangles; not searched where it is none
    bool none() const { return closed && crossing.empty(); }
  };
  static Faults find_faults(const IndexedMesh& result) {
    EdgeReport edges = check_edges(result.triangles);
    Faults faults{
        edges.closed_manifold() && !result.triangles.empty(), std::move(edges.vertices), {}};
    if (faults.closed) faults.crossing = crossing_triangles(result);
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

  Triangles collapse(std::size_t target, double error_mm) const {
    Triangles kept, free;
    for (const Triangle& t : exact_.triangles) {
      (kept_[t[0]] && kept_[t[1]] && kept_[t[2]] ? kept : free).push_back(t);
    }
    if (!free.empty()) {
      // Without a bound the size of the model is the limit: only the number of triangles counts.
      const double relative = std::min(error_mm / scale_, 1e6);
      const std::size_t goal = target > kept.size() ? target - kept.size() : 0;
      Triangles out(free.size());
      const std::size_t indices =
          meshopt_simplify(out.front().data(), free.front().data(), free.size() * 3,
                           exact_.positions_mm.front().data(), exact_.positions_mm.size(),
                           sizeof(exact_.positions_mm.front()), goal * 3,
                           static_cast<float>(relative), meshopt_SimplifyLockBorder, nullptr);
      out.resize(indices / 3);
      kept.insert(kept.end(), out.begin(), out.end());
    }
    cancel_opposites(kept);
    return kept;
  }

  struct Measured {
    double error_mm = 0;                ///< greatest distance between the two surfaces
    std::vector<std::uint32_t> beyond;  ///< vertices next to which it exceeds the bound
  };
  Measured measure(const IndexedMesh& result, double bound_mm) const {
    Measured measured;
    if (result.triangles.empty()) {
      measured.error_mm = kNoBound;
      measured.beyond.assign(kept_.size(), 0);
      return measured;  // no triangle is left
    }
    // The distance of a point from a mesh, or one that changes nothing: most points are nearer
    // than the greatest distance so far, which a search finds out early.
    const auto distance_mm = [&](const MeshNearest& mesh, Vec3 point, std::uint32_t& near) {
      const double enough_mm = std::min(measured.error_mm, bound_mm);
      const auto found = mesh.find(point, near, enough_mm * enough_mm);
      near = found.triangle;
      return std::sqrt(found.squared_mm2);
    };
    const MeshNearest to_result(result);
    std::uint32_t near = 0;
    for (std::uint32_t v = 0; v < exact_.positions_mm.size(); ++v) {
      const double d = distance_mm(to_result, exact_.position(v), near);
      measured.error_mm = std::max(measured.error_mm, d);
      if (d > bound_mm) measured.beyond.push_back(v);
    }
    near = 0;
    for (std::size_t t = 0; t < result.triangles.size(); ++t) {
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
  MeshNearest to_exact_;
  std::vector<bool> kept_;  ///< vertices of the exact mesh around which nothing is collapsed
  double scale_ = 1;
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
  auto simplified = Simplifier(exact).run(request, progress, stop);
  if (!simplified) return simplified;
  simplified->original_triangles = exact.triangles.size();
  if (request.triangles && simplified->mesh.triangles.size() > *request.triangles) {
    return budget_missed(request, simplified->mesh.triangles.size());
  }
  if (progress) progress(1);
  return simplified;
}

}  // namespace kerf
