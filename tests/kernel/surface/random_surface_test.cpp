// SPDX-License-Identifier: Apache-2.0
#include "tests/kernel/extremes/random_carving.h"
#include "tests/support/mesh_check.h"
#include "tests/support/test.h"

namespace kerf::random_surface_test {
namespace {

using test::MeshReport;
using test::RandomCarving;

void expect_closed(const MeshReport& report) {
  EXPECT_EQ(report.open_edges, 0U);
  EXPECT_EQ(report.repeated_edges, 0U);
  EXPECT_EQ(report.degenerate, 0U);
  EXPECT_EQ(report.bad_normals, 0U);
  EXPECT_GT(report.triangles, 500U);
  EXPECT_GT(report.volume_mm3, 0);
}

TEST(RandomSurface, IsAClosedManifold) {
  // More effort makes the blocks larger, and so the number of features in one cell.
  const double columns = 24 + 8 * (test::effort() - 1);
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const double pitch_mm = std::array{1.0, 0.5, 0.25, 0.1}[seed % 4];
    for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + " " + to_string(rays));
      RandomCarving carving(seed, columns * pitch_mm, pitch_mm, rays);
      expect_closed(test::check_mesh(test::mesh_all(carving.sculpture.solid())));
    }
  }
}

/// Returns the errors of corners and centroids, in pitches, in ascending order.
std::vector<double> errors_of(RandomCarving& carving) {
  std::vector<double> errors;
  const double pitch_mm = carving.sculpture.settings().pitch_mm;
  for (const TileMesh& mesh : test::mesh_all(carving.sculpture.solid())) {
    const auto corner = [&](std::size_t n) {
      const auto& p = mesh.positions_mm[mesh.indices[n]];
      return Vec3{double(p[0]), double(p[1]), double(p[2])};
    };
    for (std::size_t n = 0; n < mesh.indices.size(); n += 9) {
      const Vec3 a = corner(n), centroid = (a + corner(n + 1) + corner(n + 2)) * (1.0 / 3);
      errors.push_back(carving.error_mm(a) / pitch_mm);
      errors.push_back(carving.error_mm(centroid) / pitch_mm);
    }
  }
  std::ranges::sort(errors);
  return errors;
}

TEST(RandomSurface, IsOnTheTrueSolid) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    std::vector<double> all;
    for (unsigned seed = 1; seed <= 8U * unsigned(test::effort()); ++seed) {
      RandomCarving carving(seed, 9, 0.25, rays);
      const std::vector<double> errors = errors_of(carving);
      all.insert(all.end(), errors.begin(), errors.end());
    }
    std::ranges::sort(all);
    const auto share = [&](double s) { return all[std::size_t(s * double(all.size() - 1))]; };
    ASSERT_GT(all.size(), 10000U);
    RecordProperty(to_string(rays), std::to_string(share(0.99)));
    // Large errors occur at features that one cell cannot represent. One field locates walls to
    // half a pitch.
    const bool exact = rays == Rays::kTriDexel;
    EXPECT_LT(share(0.5), exact ? 0.002 : 0.02);
    EXPECT_LT(share(0.9), exact ? 0.05 : 0.2);
    EXPECT_LT(share(0.99), exact ? 0.15 : 0.5);
  }
}

}  // namespace
}  // namespace kerf::random_surface_test
