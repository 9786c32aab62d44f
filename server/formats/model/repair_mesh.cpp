// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/repair_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <span>
#include <unordered_map>
#include <vector>

#include "kernel/dexel/mesh_stock.h"
#include "server/formats/model/mesh_shells.h"

namespace kerf {
namespace {

/// Share of the mesh's diagonal below which vertices on open edges are joined.
constexpr double kJoinShare = 1e-5;

using Triangle = std::array<std::uint32_t, 3>;

/// Vertices in cubes whose side is the distance within which they are joined.
class VertexCells {
 public:
  VertexCells(std::span<const Vec3> vertices, Vec3 origin, double distance_mm)
      : vertices_(vertices), origin_(origin), distance_mm_(distance_mm) {}

  /// Returns the first vertex added that is within the distance, or adds this one and returns it.
  std::uint32_t join(std::uint32_t vertex) {
    const Cell at = cell_of(vertices_[vertex]);
    for (std::int64_t n = 0; n < 27; ++n) {
      const auto cell = cells_.find({at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1});
      if (cell == cells_.end()) continue;
      for (const std::uint32_t other : cell->second) {
        if (length(vertices_[other] - vertices_[vertex]) <= distance_mm_) return other;
      }
    }
    cells_[at].push_back(vertex);
    return vertex;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct CellHash {
    std::size_t operator()(const Cell& cell) const {
      std::uint64_t hash = 14695981039346656037U;
      for (const std::int64_t c : cell) {
        hash = (hash ^ static_cast<std::uint64_t>(c)) * 1099511628211U;
        hash ^= hash >> 31U;
      }
      return static_cast<std::size_t>(hash);
    }
  };

  Cell cell_of(Vec3 v) const {
    const Vec3 p = (v - origin_) * (1 / distance_mm_);
    return {std::int64_t(std::floor(p.x)), std::int64_t(std::floor(p.y)),
            std::int64_t(std::floor(p.z))};
  }

  std::span<const Vec3> vertices_;
  Vec3 origin_;
  double distance_mm_;
  std::unordered_map<Cell, std::vector<std::uint32_t>, CellHash> cells_;
};

class Repair {
 public:
  explicit Repair(TriangleMesh& mesh) : mesh_(mesh) {}

  std::expected<MeshRepair, std::string> run() {
    join_vertices();
    drop_triangles();
    MeshShells shells(mesh_);
    if (const auto at = shells.orient(); at)
      return std::unexpected("the mesh has a surface with one side only, near (" +
                             std::to_string(at->x) + ", " + std::to_string(at->y) + ", " +
                             std::to_string(at->z) + ")");
    done_.triangles_turned = shells.turned_triangles();
    close_holes(shells);
    if (!turn_shells(shells))
      return std::unexpected("the mesh has too many shells that may lie in one another");
    if (std::ranges::all_of(shells.all(), [](const MeshShell& s) { return s.volume_mm3 == 0; }))
      return std::unexpected("the mesh encloses no volume, with its holes closed too");
    return done_;
  }

 private:
  void join_vertices() {
    const BoxStock box = mesh_bounds(mesh_);
    const double distance_mm = kJoinShare * length(box.max_mm - box.min_mm);
    if (!(distance_mm > 0)) return;
    std::vector<bool> open(mesh_.vertices_mm.size());
    for_each_edge(mesh_, [&open](std::span<const EdgeUse> uses) {
      if (uses.size() == 1) open[uses[0].from] = open[uses[0].to] = true;
    });
    VertexCells cells(mesh_.vertices_mm, box.min_mm, distance_mm);
    std::vector<std::uint32_t> joined(mesh_.vertices_mm.size());
    std::iota(joined.begin(), joined.end(), 0U);
    for (std::uint32_t v = 0; v < joined.size(); ++v) {
      if (open[v]) joined[v] = cells.join(v);
      done_.vertices_joined += joined[v] == v ? 0 : 1;
    }
    for (Triangle& t : mesh_.triangles) t = {joined[t[0]], joined[t[1]], joined[t[2]]};
  }

  /// A triangle with its smallest corner first, and whether its corners ascend from there.
  static std::pair<Triangle, bool> sides_of(Triangle t) {
    std::ranges::rotate(t, std::ranges::min_element(t));
    const bool up = t[1] < t[2];
    if (!up) std::swap(t[1], t[2]);
    return {t, up};
  }

  void drop_triangles() {
    std::map<Triangle, int> facing;  // triangles on either side, as a sum of +1 and -1
    for (const Triangle& t : mesh_.triangles) {
      const auto [corners, up] = sides_of(t);
      facing[corners] += up ? 1 : -1;
    }
    const std::size_t before = mesh_.triangles.size();
    std::erase_if(mesh_.triangles, [&](const Triangle& t) {
      if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return true;
      const auto [corners, up] = sides_of(t);
      int& left = facing[corners];
      const bool keep = up ? left > 0 : left < 0;
      if (keep) left = 0;
      return !keep;
    });
    done_.triangles_dropped = before - mesh_.triangles.size();
  }

  void close_holes(MeshShells& shells) {
    for (MeshShell& shell : shells.all()) {
      for (const std::vector<std::uint32_t>& loop : open_loops(mesh_, shell)) close(loop, shell);
      shell.volume_mm3 = shells.volume_mm3(shell);
    }
  }

  /// Closes a boundary, whose vertices are in the order of the triangles that are missing.
  void close(const std::vector<std::uint32_t>& loop, MeshShell& shell) {
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      shell.triangles.push_back(static_cast<std::uint32_t>(mesh_.triangles.size()));
      mesh_.triangles.push_back({a, b, c});
    };
    double around_mm = 0;
    Vec3 sum;
    for (std::size_t n = 0; n < loop.size(); ++n) {
      const Vec3 a = mesh_.vertices_mm[loop[n]];
      const Vec3 b = mesh_.vertices_mm[loop[(n + 1) % loop.size()]];
      around_mm += length(b - a);
      sum = sum + length(b - a) * 0.5 * (a + b);
    }
    ++done_.holes_closed;
    done_.longest_hole_mm = std::max(done_.longest_hole_mm, around_mm);
    if (loop.size() == 3) return add(loop[0], loop[1], loop[2]);
    const auto middle = static_cast<std::uint32_t>(mesh_.vertices_mm.size());
    mesh_.vertices_mm.push_back(around_mm > 0 ? sum * (1 / around_mm) : mesh_.vertices_mm[loop[0]]);
    for (std::size_t n = 0; n < loop.size(); ++n) add(loop[n], loop[(n + 1) % loop.size()], middle);
  }

  /// Returns false if it would take too long to find out which shells are cavities.
  bool turn_shells(MeshShells& shells) {
    std::vector<MeshShell*> inside_out;
    for (MeshShell& shell : shells.all()) {
      if (shell.volume_mm3 >= 0) continue;
      if (!shell.was_oriented) {
        turn(shell);
        continue;
      }
      const auto inside = shells.is_inside_another(shell);
      if (!inside) return false;
      if (!*inside) inside_out.push_back(&shell);
    }
    for (MeshShell* shell : inside_out) turn(*shell);
    return true;
  }

  void turn(MeshShell& shell) {
    for (const std::uint32_t t : shell.triangles)
      std::swap(mesh_.triangles[t][1], mesh_.triangles[t][2]);
    ++done_.shells_turned;
  }

  TriangleMesh& mesh_;
  MeshRepair done_;
};

std::string count_text(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + ' ' + (count == 1 ? one : many);
}

}  // namespace

std::string to_string(const MeshRepair& repair) {
  std::string text;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (repair.vertices_joined > 0)
    add("joined " + count_text(repair.vertices_joined, "vertex", "vertices") + " to others");
  if (repair.triangles_dropped > 0)
    add("dropped " + count_text(repair.triangles_dropped, "triangle", "triangles"));
  if (repair.triangles_turned > 0)
    add("turned " + count_text(repair.triangles_turned, "triangle", "triangles"));
  if (repair.holes_closed > 0) {
    std::string longest = std::to_string(repair.longest_hole_mm);
    longest.erase(longest.find('.') + 2);
    add("closed " + count_text(repair.holes_closed, "hole", "holes") +
        " (the longest boundary: " + longest + " mm)");
  }
  if (repair.shells_turned > 0)
    add("turned " + count_text(repair.shells_turned, "shell", "shells") + " inside out");
  return text;
}

std::expected<MeshRepair, std::string> repair_mesh(TriangleMesh& mesh) {
  if (mesh_stock_fault(mesh).empty()) return MeshRepair{};
  TriangleMesh repaired = mesh;
  auto done = Repair(repaired).run();
  if (!done) return done;
  if (const std::string fault = mesh_stock_fault(repaired); !fault.empty())
    return std::unexpected("after its repair " + fault);
  mesh = std::move(repaired);
  return done;
}

}  // namespace kerf
