// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/feature_error.h"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "tests/bench/fine_surface.h"
#include "tests/kernel/extremes/random_carving.h"
#include "tests/support/mesh_check.h"

namespace kerf {
namespace {

constexpr double kWidthMm = 9, kPitchMm = 0.25;
// Refinement of the surface that locates features.
constexpr double kFiner = 6;
constexpr unsigned kCarvings = 8;
// Every n-th triangle is measured, at a corner and at its centroid.
constexpr std::size_t kEvery = 3;

struct Errors {
  std::vector<double> all, plain;
};

void judge(const test::RandomCarving& carving, const SolidSnapshot& solid, const FineSurface& fine,
           Errors& errors) {
  for (const TileMesh& mesh : test::mesh_all(solid)) {
    const auto corner = [&](std::size_t n) {
      const auto& p = mesh.positions_mm[mesh.indices[n]];
      return Vec3{double(p[0]), double(p[1]), double(p[2])};
    };
    for (std::size_t n = 0; n < mesh.indices.size(); n += 3 * kEvery) {
      const Vec3 a = corner(n), centroid = (a + corner(n + 1) + corner(n + 2)) * (1.0 / 3);
      for (const Vec3 p : {a, centroid}) {
        const double error = carving.error_mm(p) / kPitchMm;
        errors.all.push_back(error);
        if (fine.plain(p, kPitchMm)) errors.plain.push_back(error);
      }
    }
  }
}

void print(const char* where, std::vector<double>& errors, std::size_t of) {
  std::ranges::sort(errors);
  const auto share = [&](double s) { return errors[std::size_t(s * double(errors.size() - 1))]; };
  std::printf("  %-32s %5.1f %%  max %.3f, of 1000 samples 999 within %.3f, 99 of 100 %.3f pitch\n",
              where, 100.0 * double(errors.size()) / double(of), errors.back(), share(0.999),
              share(0.99));
}

}  // namespace

void print_feature_errors() {
  std::printf("random five-axis carvings, %u of %.0f columns, pitch %.2g mm; samples measured\n",
              kCarvings, kWidthMm / kPitchMm, kPitchMm);
  std::vector<Errors> errors(2);
  for (unsigned seed = 1; seed <= kCarvings; ++seed) {
    test::RandomCarving truth(seed, kWidthMm, kPitchMm / kFiner, Rays::kTriDexel);
    const FineSurface fine(test::mesh_all(truth.sculpture.solid()), kPitchMm);
    for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
      test::RandomCarving carving(seed, kWidthMm, kPitchMm, rays);
      judge(carving, carving.sculpture.solid(), fine, errors[rays == Rays::kDexel ? 0 : 1]);
    }
  }
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    Errors& e = errors[rays == Rays::kDexel ? 0 : 1];
    const std::size_t count = e.all.size();
    std::printf("%s, %zu samples\n", to_string(rays), count);
    print("everywhere", e.all, count);
    print("away from features below a pitch", e.plain, count);
  }
}

}  // namespace kerf
