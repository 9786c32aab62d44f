// SPDX-License-Identifier: Apache-2.0
#include "server/formats/model/repair_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "kernel/dexel/mesh_stock.h"
#include "server/formats/model/mesh_shells.h"
#include "server/formats/model/open_vertices.h"

namespace kerf {
namespace {

/// Share of the mesh's diagonal below which vertices on open edges are joined.
constexpr double kJoinShare = 1e-5;

using Triangle = std::array<std::uint32_t, 3>;

class Repair {
 public:
  Repair(TriangleMesh& mesh, const std::stop_token& stop) : mesh_(mesh), stop_(stop) {}

  std::expected<MeshRepair, std::string> run() {
    done_.vertices_joined = join_open_vertices(mesh_, kJoinShare);
    if (stop_.stop_requested()) return stopped();
    drop_triangles();
    if (stop_.stop_requested()) return stopped();
    MeshShells shells(mesh_);
    if (const auto at = shells.orient(); at)
      return std::unexpected("the mesh has a surface with one side only, near (" +
                             std::to_string(at->x) + ", " + std::to_string(at->y) + ", " +
                             std::to_string(at->z) + ")");
    done_.triangles_turned = shells.turned_triangles();
    if (stop_.stop_requested()) return stopped();
    close_holes(shells);
    if (!turn_shells(shells)) {
      if (stop_.stop_requested()) return stopped();
      return std::unexpected("the mesh has too many shells that may lie in one another");
    }
    if (std::ranges::all_of(shells.all(), [](const MeshShell& s) { return s.volume_mm3 == 0; }))
      return std::unexpected("the mesh encloses no volume, with its holes closed too");
    return done_;
  }

 private:
  static std::unexpected<std::string> stopped() { return std::unexpected(std::string("stopped")); }

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

  /// Closes a boundary, whose vertices are in the order of the missing triangles.
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

  /// Returns false if finding the cavities would take too long, and if a stop is requested.
  bool turn_shells(MeshShells& shells) {
    std::vector<MeshShell*> inside_out;
    for (MeshShell& shell : shells.all()) {
      if (shell.volume_mm3 >= 0) continue;
      if (!shell.was_oriented) {
        turn(shell);
        continue;
      }
      const auto inside = shells.is_inside_another(shell);
      if (!inside || stop_.stop_requested()) return false;
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
  const std::stop_token& stop_;
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

std::expected<MeshRepair, std::string> repair_mesh(TriangleMesh& mesh,
                                                   const std::stop_token& stop) {
  if (mesh_stock_fault(mesh).empty()) return MeshRepair{};
  TriangleMesh repaired = mesh;
  auto done = Repair(repaired, stop).run();
  if (!done) return done;
  if (const std::string fault = mesh_stock_fault(repaired); !fault.empty())
    return std::unexpected("after its repair " + fault);
  mesh = std::move(repaired);
  return done;
}

}  // namespace kerf
