// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "kernel/math/nearest_on_triangle.h"
#include "kernel/surface/tile_mesh.h"
#include "server/formats/model/mesh_distance.h"

namespace kerf::test {

/// Returns all tiles as one mesh without merging shared vertices, for distance queries.
inline IndexedMesh joined(const std::vector<TileMesh>& tiles) {
  IndexedMesh all;
  for (const TileMesh& mesh : tiles) {
    const auto first = static_cast<std::uint32_t>(all.positions_mm.size());
    all.positions_mm.insert(all.positions_mm.end(), mesh.positions_mm.begin(),
                            mesh.positions_mm.end());
    for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
      all.triangles.push_back(
          {first + mesh.indices[t], first + mesh.indices[t + 1], first + mesh.indices[t + 2]});
    }
  }
  return all;
}

/// A mesh of tiles with the attributes that are drawn at its vertices.
struct DrawnMesh {
  explicit DrawnMesh(const std::vector<TileMesh>& tiles) : mesh(joined(tiles)) {
    for (const TileMesh& tile : tiles) {
      normals.insert(normals.end(), tile.normals.begin(), tile.normals.end());
      original.insert(original.end(), tile.original.begin(), tile.original.end());
    }
  }
  IndexedMesh mesh;
  std::vector<std::array<float, 3>> normals;
  std::vector<std::uint8_t> original;
};

inline std::array<Vec3, 3> corners_of(const IndexedMesh& mesh, std::uint32_t triangle) {
  const auto& corners = mesh.triangles[triangle];
  return {mesh.position(corners[0]), mesh.position(corners[1]), mesh.position(corners[2])};
}

/// Returns the barycentric coordinates of a point in a triangle.
inline Vec3 parts_of(const std::array<Vec3, 3>& t, Vec3 point) {
  const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
  const double area = dot(normal, normal);
  const double b = dot(cross(point - t[0], t[2] - t[0]), normal) / area;
  const double c = dot(cross(t[1] - t[0], point - t[0]), normal) / area;
  return {1 - b - c, b, c};
}

/// A point of a mesh, and the attributes drawn there.
struct DrawnPoint {
  Vec3 place, normal;
  double original = 0;
};

inline DrawnPoint drawn_point(const DrawnMesh& drawn, std::uint32_t triangle, Vec3 parts) {
  const auto vec = [](const std::array<float, 3>& n) {
    return Vec3{double(n[0]), double(n[1]), double(n[2])};
  };
  const std::array<double, 3> part{parts.x, parts.y, parts.z};
  DrawnPoint point;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::uint32_t corner = drawn.mesh.triangles[triangle][c];
    point.place = point.place + drawn.mesh.position(corner) * part[c];
    point.normal = point.normal + vec(drawn.normals[corner]) * part[c];
    point.original += part[c] * drawn.original[corner];
  }
  point.normal = normalized(point.normal);
  return point;
}

/// Differences between a drawn coarse mesh and the exact one, at points spread over the coarse mesh
/// by area.
struct DrawnError {
  std::vector<double> off_pitches;  ///< distances
  std::vector<double> turns;        ///< differences of the unit normals
  /// Share of the points that are original where the exact surface is cut, or the reverse.
  double wrong_skin = 0;
};

/// `spacing_mm` is the approximate distance between the points.
inline DrawnError drawn_error(const std::vector<TileMesh>& exact,
                              const std::vector<TileMesh>& coarse, double pitch_mm,
                              double spacing_mm) {
  const DrawnMesh is(coarse), should_be(exact);
  const MeshDistance distance(should_be.mesh);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(0, 1);
  DrawnError error;
  std::size_t wrong_skin = 0;
  std::uint32_t near = 0;
  for (std::uint32_t t = 0; t < is.mesh.triangles.size(); ++t) {
    const std::array<Vec3, 3> corners = corners_of(is.mesh, t);
    const double area_mm2 = length(cross(corners[1] - corners[0], corners[2] - corners[0])) / 2;
    // The mean number of points of a triangle is proportional to its area.
    const auto points = static_cast<int>(area_mm2 / (spacing_mm * spacing_mm) + share(random));
    for (int n = 0; n < points; ++n) {
      double b = share(random), c = share(random);
      if (b + c > 1) {
        b = 1 - b;
        c = 1 - c;
      }
      const DrawnPoint drawn = drawn_point(is, t, {1 - b - c, b, c});
      error.off_pitches.push_back(distance.distance_mm(drawn.place, near) / pitch_mm);
      const std::array<Vec3, 3> nearest = corners_of(should_be.mesh, near);
      const Vec3 foot = nearest_on_triangle(nearest, drawn.place).point;
      const DrawnPoint truth = drawn_point(should_be, near, parts_of(nearest, foot));
      error.turns.push_back(length(drawn.normal - truth.normal));
      if (std::abs(drawn.original - truth.original) > 0.75) ++wrong_skin;
    }
  }
  error.wrong_skin = static_cast<double>(wrong_skin) / static_cast<double>(error.turns.size());
  return error;
}

}  // namespace kerf::test
