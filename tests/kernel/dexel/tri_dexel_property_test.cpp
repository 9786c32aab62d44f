// SPDX-License-Identifier: Apache-2.0
// Compares the three fields of a tri-dexel block with each other and with the true motion. One ray
// of each field passes through every point of a lattice, and there all three must agree.

#include "kernel/sculpture.h"
#include "tests/support/standard_job.h"
#include "tests/support/swept_oracle.h"
#include "tests/support/test.h"

namespace kerf::tri_dexel_property_test {
namespace {

constexpr std::array kAxes{RayAxis::kX, RayAxis::kY, RayAxis::kZ};

struct Motion {
  Tool tool;
  ToolPose from, to;
};

/// Returns the signed distance of a point from the union of all swept volumes (negative: inside).
double outside_all(const std::vector<Motion>& motions, Vec3 point) {
  double least = 1e300;
  for (const Motion& m : motions) {
    for (const ToolPiece& piece : m.tool.pieces) {
      least = std::min(least, test::swept_outside(piece, m.from, m.to, point, 150));
    }
  }
  return least;
}

/// The columns of one field, sampled at lattice points.
class Field {
 public:
  Field(Sculpture& s, RayAxis axis) : axis_(axis), snapshot_(s.snapshot(axis)) {}

  const DexelGrid& grid() const { return snapshot_.grid(); }
  Vec3 world(std::int32_t i, std::int32_t j, double depth_mm) const {
    return from_frame(axis_, {grid().x_mm(i), grid().y_mm(j), depth_mm});
  }
  std::vector<Dexel> column(std::int32_t i, std::int32_t j) const {
    std::vector<Dexel> scratch;
    const auto c = snapshot_.column(i, j, scratch);
    return {c.begin(), c.end()};
  }
  /// Returns whether the lattice point (i, j, k), in world axes, is solid in this field.
  bool solid(std::int32_t x, std::int32_t y, std::int32_t z) const {
    const std::array<std::int32_t, 3> p{x, y, z};
    const std::size_t first = axis_ == RayAxis::kZ ? 0 : axis_ == RayAxis::kX ? 1 : 2;
    const double depth_mm = (p[(first + 2) % 3] + 0.5) * grid().pitch_mm;
    for (const Dexel& d : column(p[first], p[(first + 1) % 3])) {
      if (d.bottom * grid().z_quantum_mm <= depth_mm && depth_mm <= d.top * grid().z_quantum_mm) {
        return true;
      }
    }
    return false;
  }

 private:
  RayAxis axis_;
  DexelSnapshot snapshot_;
};

struct Carved {
  std::vector<Motion> motions;
  std::unique_ptr<Sculpture> sculpture;
};

constexpr double kHalfSide = 12;
constexpr double kPitch = 0.75;

std::vector<ToolShape> shapes() {
  return {BallShape{6, 30}, FlatShape{8, 30}, TaperShape{3, 12, 30},
          TaperShape{4, 8, 30, TaperTip::kBall}, ConeEndShape{8, 90, 30}};
}

Carved carve(std::vector<Motion> motions, double tolerance) {
  SculptureSettings settings;
  settings.stock =
      BoxStock{{-kHalfSide, -kHalfSide, -kHalfSide}, {kHalfSide, kHalfSide, kHalfSide}};
  settings.rays = Rays::kTriDexel;
  settings.pitch_mm = kPitch;
  settings.tolerance_mm = tolerance;
  Carved carved{std::move(motions), std::make_unique<Sculpture>(*Sculpture::create(settings))};
  for (ToolId id = 0; id < carved.motions.size(); ++id) {
    const Motion& m = carved.motions[id];
    carved.sculpture->apply(DefineTool{id, m.tool}).value();
    carved.sculpture->apply(MoveTool{id, m.from, m.to, 0.01}).value();
  }
  return carved;
}

/// Random motions of a random tool, tilted by up to a right angle: one translation, one that turns
/// by up to 0.5 rad, and two that hardly turn.
Carved carve_at_random(unsigned seed, double tolerance) {
  std::vector<Motion> motions;
  std::mt19937 random(seed);
  const test::Uniform in(random);
  for (unsigned id = 0; id < 4; ++id) {
    const Tool tool = *make_tool(shapes()[(seed + id) % shapes().size()]);
    const Vec3 axis = normalized({in(-1, 1), in(-1, 1), in(0, 1)});
    const Vec3 side = normalized(cross(axis, Vec3{in(-1, 1), in(-1, 1), in(-1, 1)}));
    const double turn = id == 0 ? 0 : id == 1 ? in(0, 0.5) : std::pow(10, -in(1.5, 12.5));
    const Vec3 tip{in(-9, 9), in(-9, 9), in(-9, 9)};
    const ToolPose from{tip, axis};
    const ToolPose to{tip + Vec3{in(-5, 5), in(-5, 5), in(-5, 5)},
                      normalized(axis * std::cos(turn) + side * std::sin(turn))};
    motions.push_back({tool, from, to});
  }
  return carve(std::move(motions), tolerance);
}

/// Motions aligned with the lattice: along the axes and their diagonals, with tips and flat faces
/// in planes of rays or half a pitch from them, and tools along each axis.
Carved carve_on_the_lattice(unsigned seed, double tolerance) {
  std::mt19937 random(seed);
  const auto step = [&](int n) { return (int(random() % unsigned(2 * n + 1)) - n) * kPitch / 2; };
  const std::array<Vec3, 4> ups{Vec3{0, 0, 1}, Vec3{1, 0, 0}, Vec3{0, -1, 0},
                                normalized({0, 1, 1})};
  std::vector<Motion> motions;
  for (unsigned id = 0; id < 4; ++id) {
    const Tool tool = *make_tool(shapes()[(seed + id) % shapes().size()]);
    const Vec3 axis = ups[random() % ups.size()];
    const Vec3 tip{step(20), step(20), step(20)};
    const ToolPose from{tip, axis};
    const Vec3 displacements[] = {
        {step(10), 0, 0}, {0, step(10), 0}, {0, 0, step(10)}, {3, 3, 0}, {}};
    const Vec3 displacement = displacements[random() % 5];
    motions.push_back({tool, from, {tip + displacement, axis}});
  }
  return carve(std::move(motions), tolerance);
}

class TriDexel : public testing::TestWithParam<unsigned> {};

TEST_P(TriDexel, EndsOfEveryFieldAreOnTheTrueSurface) {
  constexpr double kTolerance = 0.005;
  Carved carved = carve_at_random(GetParam(), kTolerance);
  int ends = 0;
  for (const RayAxis axis : kAxes) {
    const Field field(*carved.sculpture, axis);
    for (std::int32_t j = 0; j < field.grid().columns_y; j += 2) {
      for (std::int32_t i = 0; i < field.grid().columns_x; ++i) {
        for (const Dexel& d : field.column(i, j)) {
          for (const std::int32_t end : {d.bottom, d.top}) {
            if (end == 0 || end == field.grid().height_quanta) continue;
            ++ends;
            const Vec3 p = field.world(i, j, field.grid().z_mm(end));
            EXPECT_LE(std::abs(outside_all(carved.motions, p)), kTolerance)
                << "axis " << int(axis) << " column " << i << ' ' << j << " depth " << end;
          }
        }
      }
    }
  }
  EXPECT_GT(ends, 200);
}

/// Counts the empty lattice points. The fields may differ only at points on the surface.
int expect_agreement(Carved& carved, double tolerance) {
  const Field x(*carved.sculpture, RayAxis::kX), y(*carved.sculpture, RayAxis::kY),
      z(*carved.sculpture, RayAxis::kZ);
  const auto side = static_cast<std::int32_t>(2 * kHalfSide / kPitch);
  int empty = 0;
  for (std::int32_t k = 0; k < side; ++k) {
    for (std::int32_t j = 0; j < side; ++j) {
      for (std::int32_t i = 0; i < side; ++i) {
        const bool solid = z.solid(i, j, k);
        empty += solid ? 0 : 1;
        if (x.solid(i, j, k) == solid && y.solid(i, j, k) == solid) continue;
        const Vec3 p = z.world(i, j, -kHalfSide + (k + 0.5) * kPitch);
        EXPECT_LE(std::abs(outside_all(carved.motions, p)), tolerance)
            << "point " << i << ' ' << j << ' ' << k;
      }
    }
  }
  return empty;
}

TEST_P(TriDexel, FieldsAgreeWhereTheirRaysMeet) {
  Carved carved = carve_at_random(GetParam() + 100, 0.005);
  EXPECT_GT(expect_agreement(carved, 0.005), 100);
}

TEST_P(TriDexel, FieldsAgreeForFacesInThePlanesOfTheirRays) {
  Carved carved = carve_on_the_lattice(GetParam(), 1e-6);
  EXPECT_GT(expect_agreement(carved, 1e-6), 100);
}

TEST_P(TriDexel, FieldsRemoveTheSameVolume) {
  Carved carved = carve_at_random(GetParam() + 200, 0.005);
  Sculpture& s = *carved.sculpture;
  for (const RayAxis axis : kAxes) {
    const double removed = s.stock_volume_mm3() - s.snapshot(axis).volume_mm3();
    // A wall parallel to the rays is located to half a pitch.
    EXPECT_NEAR(removed / s.removed_volume_mm3(), 1, 0.03) << "axis " << int(axis);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, TriDexel, testing::Range(0u, 20u));

TEST(TriDexelStandardJob, RemovedVolumeIsExactToHalfAPitchOfGrazedArea) {
  SculptureSettings settings = test::standard_settings(0.25, 0.001);
  settings.rays = Rays::kTriDexel;
  auto s = *Sculpture::create(settings);
  s.apply(DefineTool{1, *make_tool(BallShape{10, 50})}).value();
  const std::vector<ToolPose> path = test::standard_path(false);
  for (std::size_t i = 1; i < path.size(); ++i) {
    s.apply(MoveTool{1, path[i - 1], path[i], 0.01, false}).value();
  }
  for (const RayAxis axis : kAxes) {
    const double removed = s.stock_volume_mm3() - s.snapshot(axis).volume_mm3();
    // Rays along X and Y graze the floor of 100 x 100 mm.
    const double most = axis == RayAxis::kZ ? 10 : 0.5 * 0.25 * 1e4;
    EXPECT_NEAR(removed, test::kStandardRemovedMm3, most) << "axis " << int(axis);
  }
  EXPECT_NEAR(s.removed_volume_mm3() / test::kStandardRemovedMm3, 1, 5e-3);
}

}  // namespace
}  // namespace kerf::tri_dexel_property_test
