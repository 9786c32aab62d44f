// SPDX-License-Identifier: Apache-2.0
// Compares sweeps of tools with arcs and undercuts with the true motion, by an oracle that shares
// no code with the sweeps. Between head and neck part of a column may remain, so every solid
// element and every gap is checked, not one range per column.

#include "kernel/sculpture.h"
#include "tests/support/swept_oracle.h"
#include "tests/support/test.h"

namespace kerf::shape_property_test {
namespace {

struct Case {
  std::string name;
  ToolShape shape;
};

std::vector<Case> tools() {
  using P = ProfilePoint;
  using enum ArcBulge;
  return {{"bull_nose", BullNoseShape{10, 2, 50}},
          {"apt", AptShape{12, 2, 4.296874, 2.383567, 5, 10, 40}},
          {"barrel", AptShape{16, 60, -52, 20, 0, 0, 35}},
          {"lens", ProfileShape{{P{0, 0}, ProfileArc{{0, 16}, 10, kOut}}}},
          {"lollipop", ProfileShape{{P{0, 0}, ProfileCenteredArc{{3, 9}, {0, 5}, kOut}, P{3, 40}}}},
          {"dovetail", ProfileShape{{P{6, 0}, P{3, 6}, P{3, 40}}}},
          {"t_slot", ProfileShape{{P{0, 0}, P{6, 0}, P{6, 3}, P{2.5, 3}, P{2.5, 40}}}},
          {"corner_rounder",
           ProfileShape{{P{2, 0}, P{2, 1}, ProfileArc{{5, 4}, 3, kIn}, P{5, 40}}, 0.02}},
          {"form_cutter", ProfileShape{{P{3, 0}, ProfileArc{{5, 2}, 2, kOut}, P{2, 5},
                                        ProfileArc{{2, 9}, 3, kOut}, P{2, 40}}}}};
}

constexpr double kDepth = 14;

double outside_of(const Tool& tool, const ToolPose& a, const ToolPose& b, Vec3 p) {
  double best = 1e300;
  for (const ToolPiece& piece : tool.pieces) {
    best = std::min(best, test::swept_outside(piece, a, b, p, 60));
  }
  return best;
}

/// Checks that the middle of every solid element is not deep in the sweep, that the middle of every
/// gap is not outside it, and that every end between them is on its border.
void check_columns(const Tool& tool, const ToolPose& a, const ToolPose& b, const DexelSnapshot& s,
                   double tolerance, const std::string& what) {
  const DexelGrid& g = s.grid();
  std::vector<Dexel> scratch;
  for (int j = 0; j < g.columns_y; ++j) {
    for (int i = 0; i < g.columns_x; ++i) {
      const auto at = [&](double depth) {
        const double z = g.origin_mm.z + depth * g.z_quantum_mm;
        return outside_of(tool, a, b, {g.x_mm(i), g.y_mm(j), z});
      };
      double last = 0;
      const auto gap = [&](double from, double to) {
        if (from >= to) return;
        EXPECT_LE(at((from + to) / 2), tolerance) << what << ' ' << i << ' ' << j;
      };
      for (const Dexel& d : s.column(i, j, scratch)) {
        gap(last, d.bottom);
        EXPECT_GE(at((double(d.bottom) + d.top) / 2), -tolerance) << what << ' ' << i << ' ' << j;
        for (const std::int32_t end : {d.bottom, d.top}) {
          if (end == 0 || end == g.height_quanta) continue;
          EXPECT_LE(std::abs(at(end)), tolerance) << what << ' ' << i << ' ' << j;
        }
        last = d.top;
      }
      gap(last, g.height_quanta);
    }
  }
}

class ShapeMotion : public testing::TestWithParam<int> {};

TEST_P(ShapeMotion, StaysWithinToleranceForAnyMotion) {
  const Case c = tools()[std::size_t(GetParam())];
  const Tool tool = *make_tool(c.shape);
  std::mt19937 random(unsigned(GetParam()) + 5);
  const test::Uniform in(random);
  for (int n = 0; n < 12; ++n) {
    SculptureSettings settings{.stock = BoxStock{{-12, -12, -kDepth}, {12, 12, 0}},
                               .pitch_mm = 1.3,
                               .tolerance_mm = n % 2 == 0 ? 0.01 : 0.001};
    auto sculpture = *Sculpture::create(settings);
    sculpture.apply(DefineTool{1, tool}).value();
    const Vec3 axis = normalized({in(-0.7, 0.7), in(-0.7, 0.7), 1});
    const double turn = n % 4 == 0 ? 0 : n % 4 == 1 ? in(0.1, 0.6) : in(0, 0.1);
    const Vec3 side = normalized(cross(axis, Vec3{in(-1, 1), in(-1, 1), in(-1, 1)}));
    const ToolPose a{{in(-3, 3), in(-3, 3), in(-11, -6)}, axis};
    ToolPose b{a.tip_mm + Vec3{in(-4, 4), in(-4, 4), in(-1, 1)},
               normalized(axis * std::cos(turn) + side * std::sin(turn))};
    if (n % 4 == 3)
      b.tip_mm = a.tip_mm + (a.axis - b.axis) * in(0, 20);  // A turn about a point of the axis.
    sculpture.apply(MoveTool{1, a, b, 0.01}).value();
    check_columns(tool, a, b, sculpture.snapshot(), settings.tolerance_mm,
                  c.name + " motion " + std::to_string(n));
  }
}

INSTANTIATE_TEST_SUITE_P(EveryTool, ShapeMotion, testing::Range(0, 9),
                         [](const auto& tool) { return tools()[std::size_t(tool.param)].name; });

}  // namespace
}  // namespace kerf::shape_property_test
