#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "tests/kernel/extremes/carving.h"
#include "tests/kernel/extremes/true_sweep.h"
#include "tests/support/mesh_check.h"

namespace kerf {
namespace {

using test::MeshReport;
using test::TrueSweep;

class Numbers {
 public:
  explicit Numbers(unsigned seed) : random_(seed) {}
  double in(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 4294967296.0);
  }
  Vec3 vec(double size) {
    const double x = in(-size, size), y = in(-size, size), z = in(-size, size);
    return {x, y, z};
  }

 private:
  std::mt19937 random_;
};

/// A block of so many columns that every tool has carved in five axes, and the true sweeps.
struct RandomCarving {
  Vec3 size_mm;
  Sculpture sculpture;
  std::vector<TrueSweep> sweeps;

  RandomCarving(unsigned seed, double columns, double pitch_mm, Rays rays)
      : size_mm(Vec3{1.01, 0.97, 0.7} * (columns * pitch_mm)),
        sculpture(*Sculpture::create(settings(size_mm, pitch_mm, rays))) {
    Numbers numbers(seed);
    const double w = columns * pitch_mm;
    const auto tools = test::every_tool(w / 25);
    constexpr unsigned kMotions = 8;
    for (unsigned n = 0; n < kMotions; ++n) {
      const std::size_t t = (seed + 7 * n) % tools.size();
      const auto id = static_cast<ToolId>(n);
      EXPECT_TRUE(sculpture.apply(DefineTool{id, tools[t].tool}));
      const Vec3 tip{numbers.in(0, w), numbers.in(0, w), numbers.in(0.2 * w, 0.75 * w)};
      const ToolPose from{tip, normalized(numbers.vec(1) + Vec3{0, 0, 1})};
      const ToolPose to{tip + numbers.vec(0.3 * w), normalized(from.axis + numbers.vec(0.3))};
      // A turn beyond 170 degrees is refused.
      if (sculpture.apply(MoveTool{id, from, to, 1, false})) {
        sweeps.emplace_back(tools[t].tool, from, to);
      }
    }
  }

  static SculptureSettings settings(Vec3 size_mm, double pitch_mm, Rays rays) {
    SculptureSettings s;
    s.stock = BoxStock{{0, 0, 0}, size_mm};
    s.pitch_mm = pitch_mm;
    s.tolerance_mm = 1e-3 * pitch_mm;
    s.rays = rays;
    return s;
  }
  /// How far a point is off the surface of the true solid, mm, as far as that is below a pitch.
  double error_mm(Vec3 p) const {
    double outside =
        std::max({-p.x, p.x - size_mm.x, -p.y, p.y - size_mm.y, -p.z, p.z - size_mm.z});
    for (const TrueSweep& sweep : sweeps) {
      outside = std::max(outside, -sweep.outside(p, sculpture.settings().pitch_mm));
    }
    return std::abs(outside);
  }
};

void expect_closed(const MeshReport& report) {
  EXPECT_EQ(report.open_edges, 0U);
  EXPECT_EQ(report.repeated_edges, 0U);
  EXPECT_EQ(report.degenerate, 0U);
  EXPECT_EQ(report.bad_normals, 0U);
  EXPECT_GT(report.triangles, 500U);
  EXPECT_GT(report.volume_mm3, 0);
}

TEST(RandomSurface, IsClosedAndManifoldWhateverCarvedIt) {
  // By more effort the blocks grow, and the features that one cell holds with them.
  const double columns = 24 + 8 * (test::effort() - 1);
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const double pitch_mm = std::array{1.0, 0.5, 0.25, 0.1}[seed % 4];
    for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + " " + to_string(rays));
      RandomCarving carving(seed, columns, pitch_mm, rays);
      expect_closed(test::check_mesh(test::mesh_all(carving.sculpture.solid())));
    }
  }
}

/// Errors of corners and centroids, in pitches, in ascending order.
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

TEST(RandomSurface, LiesOnTheTrueSolid) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    std::vector<double> all;
    for (unsigned seed = 1; seed <= 8U * unsigned(test::effort()); ++seed) {
      RandomCarving carving(seed, 36, 0.25, rays);
      const std::vector<double> errors = errors_of(carving);
      all.insert(all.end(), errors.begin(), errors.end());
    }
    std::ranges::sort(all);
    const auto share = [&](double s) { return all[std::size_t(s * double(all.size() - 1))]; };
    ASSERT_GT(all.size(), 10000U);
    RecordProperty(to_string(rays), std::to_string(share(0.99)));
    // What is far off lies at features that one cell cannot hold. One field knows walls to half a
    // pitch.
    const bool exact = rays == Rays::kTriDexel;
    EXPECT_LT(share(0.5), exact ? 0.002 : 0.02);
    EXPECT_LT(share(0.9), exact ? 0.05 : 0.2);
    EXPECT_LT(share(0.99), exact ? 0.15 : 0.5);
  }
}

}  // namespace
}  // namespace kerf
