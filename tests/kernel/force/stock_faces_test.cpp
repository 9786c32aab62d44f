// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/stock_faces.h"

#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::stock_faces_test {
namespace {

const Vec3 kUp{0, 0, 1};

/// Returns a block with its top at z = 0 and a tool 1.
Sculpture block(const ToolShape& shape, double pitch_mm = 0.25) {
  auto s =
      *Sculpture::create({.stock = BoxStock{{-20, -20, -20}, {20, 20, 0}}, .pitch_mm = pitch_mm});
  s.apply(DefineTool{1, *make_tool(shape)}).value();
  return s;
}

ContactPlane only_plane(const Sculpture& s, const ToolPose& pose) {
  const std::vector<ContactPlane> planes = s.contact(1, pose, false);
  EXPECT_EQ(planes.size(), 1U);
  return planes.empty() ? ContactPlane{} : planes.front();
}

/// A tool that leans on a face is pushed along the face's normal. The normal of the tool's own
/// surface turns with the tool, and a force that turns with the pushed body drives it.
TEST(StockFaces, LeaningToolIsPushedAlongTheFaceNormal) {
  for (const ToolShape& shape : {ToolShape(FlatShape{12, 40}), ToolShape(TaperShape{6, 6, 40})}) {
    const Sculpture s = block(shape);
    for (const double tilt : {0.0, 0.05, 0.2, 0.5}) {
      const Vec3 axis{std::sin(tilt), 0, std::cos(tilt)};
      const ContactPlane plane = only_plane(s, {{0.1, 0.05, -0.4}, axis});
      EXPECT_NEAR(length(plane.normal - kUp), 0, 1e-6) << tilt;
    }
  }
}

TEST(StockFaces, WallBetweenColumnsPushesAlongItsNormal) {
  const Sculpture s = block(FlatShape{12, 40});
  const ContactPlane plane = only_plane(s, {{-25, 0, -30}, kUp});
  EXPECT_NEAR(plane.normal.x, -1, 0.01);
}

/// The bottom of a leaning tool cuts off the edge of a block: a wedge between the top, z = 0, and
/// the wall, x = 0. Samples of every `step`th column see the areas of both faces, whichever column
/// the wall is at.
TEST(StockFaces, SamplesOfAnySpacingMeasureTheFacesOfAWedge) {
  constexpr double kWidth = 20, kPitch = 0.1;
  const DexelField field(BoxStock{{-20, -20, -20}, {0, 20, 0}}, kPitch);
  const DexelGrid& grid = field.grid();
  for (const double lean : {0.5, std::numbers::pi / 4, 1.1}) {
    const Vec3 inward{std::sin(lean), 0, std::cos(lean)};
    const double depth = 6 * std::sin(lean) * std::cos(lean);  // of the edge
    const double top_mm2 = depth / inward.x * kWidth, wall_mm2 = depth / inward.z * kWidth;
    // Each face counts by the square of its cosine with the tool's direction.
    const Vec3 expected =
        normalized({wall_mm2 * inward.x * inward.x, 0, top_mm2 * inward.z * inward.z});
    for (const std::int32_t step : {1, 3, 7}) {
      for (std::int32_t first = 0; first < step; ++first) {
        StockFaces faces;
        for (std::int32_t j = first; j < grid.columns_y; j += step) {
          for (std::int32_t i = first; i < grid.columns_x; i += step) {
            const double lo = -(depth + inward.x * grid.x_mm(i)) / inward.z;
            if (std::abs(grid.y_mm(j)) < kWidth / 2 && lo < 0)
              faces.add(field, i, j, {step, step}, lo, 0);
          }
        }
        EXPECT_LT(length(faces.towards(inward) - expected), 0.03 + 0.08 * step * kPitch)
            << lean << ", " << step << ", " << first;
      }
    }
  }
}

/// A contact whose depth is small relative to the slope over one step touches a slope, not a stair.
TEST(StockFaces, ShallowContactWithASlopeIsAlongItsNormal) {
  constexpr double kRadius = 30, kPitch = 0.1;
  const DexelField field(CylinderStock{0, 0, kRadius, -20, 20}, kPitch, RayAxis::kX);
  const DexelGrid& grid = field.grid();
  constexpr double kAngle = 0.5, kDepth = 0.1;
  const Vec3 normal{std::cos(kAngle), std::sin(kAngle), 0};
  // In the frame of a field along X, a column's first coordinate is y.
  const auto side = std::int32_t((kRadius * normal.y - grid.origin_mm.x) / kPitch);
  const double y_mm = grid.x_mm(side), x_mm = std::sqrt(kRadius * kRadius - y_mm * y_mm);
  for (const std::int32_t step : {1, 7}) {
    StockFaces faces;
    std::vector<Dexel> scratch;
    const double end_mm = grid.z_mm(field.column(side, 100, scratch).back().top);
    ASSERT_NEAR(end_mm, x_mm, 1e-6);
    faces.add(field, side, 100, {step, step}, end_mm - kDepth, end_mm);
    EXPECT_LT(length(faces.towards(normal) - normal), 0.03) << step;
  }
}

/// A leaning tool whose bottom is at 45 degrees to both faces of a carved step is pushed along its
/// axis, wherever the edge is between the samples.
TEST(StockFaces, PushOnALeaningToolDoesNotDependOnTheStepPosition) {
  Sculpture s = block(FlatShape{12, 40}, 0.1);
  s.apply(MoveTool{1, {{6, -40, -8}, kUp}, {{6, 40, -8}, kUp}, 1, false}).value();
  const Vec3 axis = normalized({1, 0, 1});
  for (int n = 0; n < 20; ++n) {
    const Vec3 edge{0, 0.1 * n, 0};
    const double depth = 0.6 + 0.03 * n;
    const ContactPlane plane = only_plane(s, {edge - axis * depth, axis});
    EXPECT_LT(length(plane.normal - axis), 0.12) << n;
    EXPECT_NEAR(plane.depth_mm, depth, 0.1) << n;
  }
}

}  // namespace
}  // namespace kerf::stock_faces_test
