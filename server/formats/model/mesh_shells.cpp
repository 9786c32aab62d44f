// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/mesh_shells.h"

#include <algorithm>
#include <map>
#include <utility>

namespace kerf {
namespace {

/// Most triangles visited by all searches for cavities: about a second.
constexpr std::uint64_t kCrossingsMax = 200'000'000;

/// Whether a ray upward from p crosses a triangle. Its outline in xy is half-open, so a ray through
/// an edge crosses one of the two triangles there.
bool is_above(Vec3 p, const std::array<Vec3, 3>& c) {
  bool inside = false;
  for (std::size_t n = 0; n < 3; ++n) {
    const Vec3 a = c[n], b = c[(n + 1) % 3];
    if ((a.y > p.y) == (b.y > p.y)) continue;
    const Vec3 &low = a.y < b.y ? a : b, &high = a.y < b.y ? b : a;
    if ((p.x - low.x) * (high.y - low.y) < (high.x - low.x) * (p.y - low.y)) inside = !inside;
  }
  if (!inside) return false;
  const Vec3 normal = cross(c[1] - c[0], c[2] - c[0]);
  const double height = c[0].z - (normal.x * (p.x - c[0].x) + normal.y * (p.y - c[0].y)) / normal.z;
  return height > p.z;
}

}  // namespace

void for_each_edge(const TriangleMesh& mesh,
                   const std::function<void(std::span<const EdgeUse>)>& visit) {
  std::vector<EdgeUse> uses;
  uses.reserve(3 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t n = 0; n < 3; ++n) {
      const std::uint32_t a = mesh.triangles[t][n], b = mesh.triangles[t][(n + 1) % 3];
      if (a != b) uses.push_back({std::min(a, b), std::max(a, b), t, a < b});
    }
  }
  const auto edge = [](const EdgeUse& use) { return std::uint64_t{use.from} << 32U | use.to; };
  std::ranges::stable_sort(uses, {}, edge);
  for (std::size_t first = 0, end = 0; first < uses.size(); first = end) {
    while (end < uses.size() && edge(uses[end]) == edge(uses[first])) ++end;
    visit(std::span(uses).subspan(first, end - first));
  }
}

MeshShells::MeshShells(TriangleMesh& mesh) : mesh_(mesh), neighbors_(mesh.triangles.size()) {
  for_each_edge(mesh, [this](std::span<const EdgeUse> uses) {
    if (uses.size() != 2) return;
    neighbors_[uses[0].triangle].push_back(uses[1].triangle);
    neighbors_[uses[1].triangle].push_back(uses[0].triangle);
  });
  std::vector<bool> seen(mesh.triangles.size());
  for (std::uint32_t first = 0; first < mesh.triangles.size(); ++first) {
    if (seen[first]) continue;
    seen[first] = true;
    MeshShell shell{{first}};
    for (std::size_t n = 0; n < shell.triangles.size(); ++n) {
      for (const std::uint32_t next : neighbors_[shell.triangles[n]]) {
        if (!seen[next]) shell.triangles.push_back(next);
        seen[next] = true;
      }
    }
    shells_.push_back(std::move(shell));
  }
}

namespace {

/// Whether two triangles with a common edge use it in opposite directions, as neighbors do.
bool agree(const std::array<std::uint32_t, 3>& a, const std::array<std::uint32_t, 3>& b) {
  for (std::size_t m = 0; m < 3; ++m) {
    for (std::size_t n = 0; n < 3; ++n) {
      if (a[m] == b[(n + 1) % 3] && a[(m + 1) % 3] == b[n]) return true;
    }
  }
  return false;
}

}  // namespace

std::optional<Vec3> MeshShells::orient() {
  // State of each triangle: unknown, as in the file, or turned.
  std::vector<signed char> side(mesh_.triangles.size());
  for (MeshShell& shell : shells_) {
    side[shell.triangles.front()] = 1;
    double area_mm2_by_side[2] = {0, 0};
    for (const std::uint32_t t : shell.triangles) {
      area_mm2_by_side[side[t] > 0 ? 0 : 1] += area_mm2(t);
      for (const std::uint32_t next : neighbors_[t]) {
        const auto wanted = static_cast<signed char>(
            agree(mesh_.triangles[t], mesh_.triangles[next]) ? side[t] : -side[t]);
        if (side[next] == -wanted) return mesh_.vertices_mm[mesh_.triangles[t][0]];
        side[next] = wanted;
      }
    }
    const int kept = area_mm2_by_side[0] >= area_mm2_by_side[1] ? 1 : -1;
    for (const std::uint32_t t : shell.triangles) {
      if (side[t] == kept) continue;
      std::swap(mesh_.triangles[t][1], mesh_.triangles[t][2]);
      shell.was_oriented = false;
      ++turned_;
    }
  }
  return std::nullopt;
}

std::array<Vec3, 3> MeshShells::corners(std::uint32_t triangle) const {
  const auto& t = mesh_.triangles[triangle];
  return {mesh_.vertices_mm[t[0]], mesh_.vertices_mm[t[1]], mesh_.vertices_mm[t[2]]};
}

double MeshShells::area_mm2(std::uint32_t triangle) const {
  const auto c = corners(triangle);
  return 0.5 * length(cross(c[1] - c[0], c[2] - c[0]));
}

double MeshShells::volume_mm3(const MeshShell& shell) const {
  const Vec3 origin = corners(shell.triangles.front())[0];
  double six = 0;
  for (const std::uint32_t t : shell.triangles) {
    const auto c = corners(t);
    six += dot(c[0] - origin, cross(c[1] - origin, c[2] - origin));
  }
  return six / 6;
}

MeshShells::Box MeshShells::box_of(const MeshShell& shell) const {
  Box box{corners(shell.triangles.front())[0], corners(shell.triangles.front())[0]};
  for (const std::uint32_t t : shell.triangles) {
    for (const Vec3& v : corners(t)) {
      box.min_mm = {std::min(box.min_mm.x, v.x), std::min(box.min_mm.y, v.y),
                    std::min(box.min_mm.z, v.z)};
      box.max_mm = {std::max(box.max_mm.x, v.x), std::max(box.max_mm.y, v.y),
                    std::max(box.max_mm.z, v.z)};
    }
  }
  return box;
}

bool MeshShells::contains(const Box& outer, const Box& inner) {
  return outer.min_mm.x <= inner.min_mm.x && inner.max_mm.x <= outer.max_mm.x &&
         outer.min_mm.y <= inner.min_mm.y && inner.max_mm.y <= outer.max_mm.y &&
         outer.min_mm.z <= inner.min_mm.z && inner.max_mm.z <= outer.max_mm.z;
}

std::optional<bool> MeshShells::is_inside_another(const MeshShell& shell) {
  if (boxes_.empty()) {
    for (const MeshShell& each : shells_) boxes_.push_back(box_of(each));
  }
  const auto c = corners(*std::ranges::max_element(
      shell.triangles, {}, [this](std::uint32_t t) { return area_mm2(t); }));
  const Vec3 p = (c[0] + c[1] + c[2]) * (1.0 / 3);
  const Box& own = boxes_[static_cast<std::size_t>(&shell - shells_.data())];
  bool inside = false;
  for (std::size_t n = 0; n < shells_.size(); ++n) {
    if (&shells_[n] == &shell || !contains(boxes_[n], own)) continue;
    crossings_tested_ += shells_[n].triangles.size();
    if (crossings_tested_ > kCrossingsMax) return std::nullopt;
    for (const std::uint32_t t : shells_[n].triangles) {
      if (is_above(p, corners(t))) inside = !inside;
    }
  }
  return inside;
}

std::vector<std::vector<std::uint32_t>> open_loops(const TriangleMesh& mesh,
                                                   const MeshShell& shell) {
  // Edges that triangles of the shell use once more in one direction than in the other.
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> surplus;
  for (const std::uint32_t t : shell.triangles) {
    for (std::size_t n = 0; n < 3; ++n) {
      const std::uint32_t a = mesh.triangles[t][n], b = mesh.triangles[t][(n + 1) % 3];
      surplus[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  }
  // The missing triangles use these edges in the opposite direction.
  std::map<std::uint32_t, std::vector<std::uint32_t>> next;
  for (const auto& [edge, count] : surplus) {
    const auto [from, to] = count > 0 ? std::pair(edge.second, edge.first) : edge;
    for (int n = 0; n < std::abs(count); ++n) next[from].push_back(to);
  }
  std::vector<std::vector<std::uint32_t>> loops;
  for (auto& [start, ends] : next) {
    while (!ends.empty()) {
      // Walks until a vertex repeats. The vertices in between are a loop.
      std::vector<std::uint32_t> path{start};
      std::map<std::uint32_t, std::size_t> place{{start, 0}};
      while (!path.empty() && !next[path.back()].empty()) {
        const std::uint32_t to = next[path.back()].back();
        next[path.back()].pop_back();
        if (const auto found = place.find(to); found != place.end()) {
          const auto first = path.begin() + static_cast<std::ptrdiff_t>(found->second);
          loops.emplace_back(first, path.end());
          for (auto v = first + 1; v != path.end(); ++v) place.erase(*v);
          path.erase(first + 1, path.end());
        } else {
          place[to] = path.size();
          path.push_back(to);
        }
      }
    }
  }
  return loops;
}

}  // namespace kerf
