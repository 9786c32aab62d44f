// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/fine_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "tests/support/mesh_check.h"

namespace kerf {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
// Cosines of the angle between neighboring triangles at a crease, of the greatest turn of one face,
// and of the angle between the normals of two faces that form a wedge.
constexpr double kCrease = 0.9, kTurn = 0.5, kWedge = -0.866;
// Relative to the ball's radius squared. A smaller area is a sliver next to a crease, not a face.
constexpr double kFaceArea = 0.03;
// Relative to the ball's radius: distance within which three faces form a corner.
constexpr double kCornerReach = 0.3;

}  // namespace

FineSurface::FineSurface(const std::vector<TileMesh>& meshes, double size_mm) : size_mm_(size_mm) {
  std::unordered_map<std::array<float, 3>, std::uint32_t, test::PositionHash> number;
  for (const TileMesh& mesh : meshes) {
    std::vector<std::uint32_t> corner;
    for (const auto& p : mesh.positions_mm) {
      const auto [at, fresh] = number.emplace(p, static_cast<std::uint32_t>(corners_.size()));
      if (fresh) corners_.push_back({double(p[0]), double(p[1]), double(p[2])});
      corner.push_back(at->second);
    }
    for (std::size_t n = 0; n + 2 < mesh.indices.size(); n += 3) {
      Triangle t{.corners = {corner[mesh.indices[n]], corner[mesh.indices[n + 1]],
                             corner[mesh.indices[n + 2]]},
                 .normal = {},
                 .area_mm2 = 0,
                 .neighbours = {kNone, kNone, kNone}};
      const Vec3 a = corners_[t.corners[0]];
      const Vec3 square = cross(corners_[t.corners[1]] - a, corners_[t.corners[2]] - a);
      t.area_mm2 = length(square) / 2;
      if (t.area_mm2 > 0) t.normal = square * (0.5 / t.area_mm2);
      triangles_.push_back(t);
    }
  }
  join_neighbours();
  fill_boxes();
}

void FineSurface::join_neighbours() {
  std::unordered_map<std::uint64_t, std::pair<std::uint32_t, int>> edges;
  for (std::uint32_t n = 0; n < triangles_.size(); ++n) {
    for (unsigned c = 0; c < 3; ++c) {
      const std::uint64_t a = triangles_[n].corners[c], b = triangles_[n].corners[(c + 1) % 3];
      const auto opposite = edges.find(b << 32U | a);
      if (opposite == edges.end()) {
        edges.emplace(a << 32U | b, std::pair(n, int(c)));
        continue;
      }
      triangles_[n].neighbours[c] = opposite->second.first;
      triangles_[opposite->second.first].neighbours[std::size_t(opposite->second.second)] = n;
    }
  }
}

std::int64_t FineSurface::box_of(std::int64_t x, std::int64_t y, std::int64_t z) const {
  constexpr std::int64_t kSide = 1 << 20;
  return (z * kSide + y) * kSide + x;
}

void FineSurface::fill_boxes() {
  const auto index = [this](double v) {
    return static_cast<std::int64_t>(std::floor(v / size_mm_)) + 1;
  };
  for (std::uint32_t n = 0; n < triangles_.size(); ++n) {
    Vec3 low = corners_[triangles_[n].corners[0]], high = low;
    for (const std::uint32_t c : triangles_[n].corners) {
      const Vec3 p = corners_[c];
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    for (std::int64_t z = index(low.z); z <= index(high.z); ++z)
      for (std::int64_t y = index(low.y); y <= index(high.y); ++y)
        for (std::int64_t x = index(low.x); x <= index(high.x); ++x)
          boxes_[box_of(x, y, z)].push_back(n);
  }
}

double FineSurface::distance(Vec3 p, const Triangle& t) const {
  const Vec3 a = corners_[t.corners[0]], b = corners_[t.corners[1]], c = corners_[t.corners[2]];
  const Vec3 foot = p - t.normal * dot(p - a, t.normal);
  bool inside = t.area_mm2 > 0;
  double best = std::numeric_limits<double>::infinity();
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
    const Vec3 edge = to - from;
    inside &= dot(cross(edge, foot - from), t.normal) >= 0;
    const double size = dot(edge, edge);
    const double share = size > 0 ? std::clamp(dot(p - from, edge) / size, 0.0, 1.0) : 0;
    best = std::min(best, length(p - from - edge * share));
  }
  return inside ? length(p - foot) : best;
}

std::vector<std::uint32_t> FineSurface::near(Vec3 p, double radius_mm) const {
  const auto index = [this](double v) {
    return static_cast<std::int64_t>(std::floor(v / size_mm_)) + 1;
  };
  std::vector<std::uint32_t> found;
  for (std::int64_t z = index(p.z - radius_mm); z <= index(p.z + radius_mm); ++z)
    for (std::int64_t y = index(p.y - radius_mm); y <= index(p.y + radius_mm); ++y)
      for (std::int64_t x = index(p.x - radius_mm); x <= index(p.x + radius_mm); ++x) {
        const auto box = boxes_.find(box_of(x, y, z));
        if (box != boxes_.end()) found.insert(found.end(), box->second.begin(), box->second.end());
      }
  std::ranges::sort(found);
  found.erase(std::ranges::unique(found).begin(), found.end());
  std::erase_if(found, [&](std::uint32_t n) { return distance(p, triangles_[n]) > radius_mm; });
  return found;
}

std::vector<FineSurface::Face> FineSurface::faces(const std::vector<std::uint32_t>& near,
                                                  double radius_mm) const {
  std::map<std::uint32_t, bool> taken;
  for (const std::uint32_t n : near) taken[n] = false;
  std::vector<Face> faces;
  for (const std::uint32_t start : near) {
    if (taken[start]) continue;
    taken[start] = true;
    Face face{.first = triangles_[start].normal, .triangles = {start}};
    for (std::size_t k = 0; k < face.triangles.size(); ++k) {
      const Triangle& t = triangles_[face.triangles[k]];
      face.area_mm2 += t.area_mm2;
      face.normal_sum = face.normal_sum + t.normal * t.area_mm2;
      for (const std::uint32_t n : t.neighbours) {
        const auto at = taken.find(n);
        if (at == taken.end() || at->second || dot(t.normal, triangles_[n].normal) < kCrease)
          continue;
        at->second = true;
        face.triangles.push_back(n);
      }
    }
    const Vec3 mean = normalized(face.normal_sum);
    for (const std::uint32_t n : face.triangles)
      if (triangles_[n].area_mm2 > kFaceArea * radius_mm * radius_mm / 10)
        face.turned = std::min(face.turned, dot(mean, triangles_[n].normal));
    if (face.area_mm2 > kFaceArea * radius_mm * radius_mm) faces.push_back(std::move(face));
  }
  return faces;
}

bool FineSurface::meet(const std::vector<Face>& faces, double reach_mm) const {
  for (const std::uint32_t n : faces.front().triangles) {
    for (const std::uint32_t corner : triangles_[n].corners) {
      const bool all = std::all_of(faces.begin() + 1, faces.end(), [&](const Face& face) {
        return std::ranges::any_of(face.triangles, [&](std::uint32_t other) {
          return distance(corners_[corner], triangles_[other]) <= reach_mm;
        });
      });
      if (all) return true;
    }
  }
  return false;
}

bool FineSurface::plain(Vec3 point, double radius_mm) const {
  const std::vector<Face> all = faces(near(point, radius_mm), radius_mm);
  if (all.empty() || all.size() > 3) return false;
  for (const Face& face : all) {
    if (face.turned < kTurn) return false;
    for (const Face& other : all)
      if (dot(normalized(face.normal_sum), normalized(other.normal_sum)) < kWedge) return false;
  }
  return all.size() == 1 || meet(all, kCornerReach * radius_mm);
}

}  // namespace kerf
