// SPDX-License-Identifier: Apache-2.0
// Section 2: updates of dexels, cutting profiles, swept volumes.

#include "tests/paper/volume_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <numbers>
#include <random>

#include "tests/kernel/extremes/carving.h"
#include "tests/paper/check.h"
#include "tests/paper/examples.h"

namespace kerf::paper {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kBlockHeightMm = 10, kWideBallMm = 7;

/// Fig. 1: each column that the ball meets has the ends of the circle, and all other columns are
/// whole.
Finding dexels_are_shortened_and_broken() {
  int met = 0;
  bool holds = true;
  for (const double height : {kBlockHeightMm, 0.0, kBlockHeightMm / 2}) {
    Sculpture block = columns_cut_at(height);
    const DexelSnapshot field = block.snapshot();
    const DexelGrid& grid = field.grid();
    for (std::int32_t n = 0; n < grid.columns_x * grid.columns_y; ++n) {
      const double dx = grid.x_mm(n % grid.columns_x) - 10;
      const double reach = kWideBallMm * kWideBallMm / 4 - dx * dx;
      std::vector<double> expected{0, kBlockHeightMm};
      if (reach > 0) {
        const double low = height - std::sqrt(reach), high = height + std::sqrt(reach);
        expected = {};
        if (low > 0) expected.insert(expected.end(), {0, low});
        if (high < kBlockHeightMm) expected.insert(expected.end(), {high, kBlockHeightMm});
        ++met;
      }
      std::vector<Dexel> scratch;
      const auto column = field.column(n % grid.columns_x, n / grid.columns_x, scratch);
      holds = holds && 2 * column.size() == expected.size();
      for (std::size_t k = 0; holds && k < column.size(); ++k) {
        holds = std::abs(grid.z_mm(column[k].bottom) - expected[2 * k]) < 1e-6 &&
                std::abs(grid.z_mm(column[k].top) - expected[2 * k + 1]) < 1e-6;
      }
    }
  }
  return {
      holds && met == 3 * 4 * 4,
      text("%d columns lose their top, their bottom or their middle, with the ends of the circle "
           "within 1e-6 mm",
           met)};
}

/// Eq. 1 and 8: where a cone that moves along a slope has left its envelope, n·V is 0 and the
/// azimuth of the normal is the cutting profile angle.
Finding cones_leave_their_cutting_profile() {
  double worst = 0;
  long ends = 0;
  std::mt19937_64 random(3);
  const auto in = [&](double a, double b) {
    return a + (b - a) * double(random() >> 11) * 0x1p-53;
  };
  for (int n = 0; n < 12; ++n) {
    const double half_angle = in(8, 35), slope = -in(3, 0.9 * (90 - half_angle)) * kDegree;
    const TaperShape shape{4, half_angle, 24};
    SculptureSettings settings{.stock = BoxStock{{-20, -20, -12}, {20, 20, 0}}};
    Sculpture block = block_of(settings, shape);
    const Vec3 d = Vec3{std::cos(slope), 0, std::sin(slope)} * 8.0, from{-4, 0.01, -2};
    block.apply(MoveTool{1, {from}, {from + d}, 0, false}).value();
    const double k = std::tan(half_angle * kDegree);
    const double profile = std::acos(std::clamp(std::tan(slope) * k, -1.0, 1.0));  // Eq. 8
    const DexelSnapshot field = block.snapshot();
    const DexelGrid& grid = field.grid();
    for (std::int32_t c = 0; c < grid.columns_x * grid.columns_y; ++c) {
      const std::int32_t i = c % grid.columns_x, j = c / grid.columns_x;
      const ColumnView column = field.view(i, j);
      const Vec3 at{grid.x_mm(i), grid.y_mm(j), grid.z_mm(column.topmost.top)};
      const Vec3 normal = -field.normal(i, j, column.topmost.top, true, column.topmost_codes.top);
      const auto off_cone = [&](Vec3 tip) {  // distance from the side of the cone at a pose
        return (std::hypot(at.x - tip.x, at.y - tip.y) - 2 - k * (at.z - tip.z)) / std::hypot(1, k);
      };
      const bool side = std::abs(normal.z + k / std::hypot(1, k)) < 1e-3;
      if (!side || off_cone(from) < 0.01 || off_cone(from + d) < 0.01) continue;
      worst = std::max(worst, std::abs(std::abs(std::atan2(normal.y, normal.x)) - profile));
      worst = std::max(worst, std::abs(dot(normal, normalized(d))));
      ++ends;
    }
  }
  return {ends > 1000 && worst < 1e-3,
          text("%ld ends on the envelopes of 12 cones: n·V = 0 and Eq. 8 within %.4f°", ends,
               worst / kDegree)};
}

struct Kind {
  const char* name;
  ToolPose from, to;
};

std::array<Kind, 4> kinds() {
  const ToolPose a = test::leaning({-3, 0.3, -5}, 0.3, 0.4);
  const ToolPose c = test::leaning({2, 1.3, -6.5}, 0.75, 0.9);
  return {{{"(1) along the axis", a, {a.tip_mm + a.axis * -3.0, a.axis}},
           {"(2) rotation", a, {a.tip_mm, c.axis}},
           {"(3) translation", a, {c.tip_mm, a.axis}},
           {"(4) both", a, c}}};
}

constexpr std::array kModels{MotionModel::kPaper, MotionModel::kTight};
constexpr std::array kTolerances{0.1, 0.01};

/// Worst error of every tool in a motion, and the mean of its cuts.
struct Sweep {
  double error_mm = 0, cuts = 0;
};

Sweep sweep_of(const Kind& kind, MotionModel model, double tolerance_mm) {
  Sweep sweep;
  const auto tools = test::every_tool();
  for (const test::NamedTool& tool : tools) {
    SculptureSettings settings = test::block(40, 16, 0.8, tolerance_mm);
    settings.motion = model;
    settings.keep_normals = false;
    test::Carving carving(settings, tool.tool);
    sweep.cuts += carving.move(kind.from, kind.to).sub_motions / double(tools.size());
    sweep.error_mm = std::max(sweep.error_mm, carving.error_mm(5, 20 * tolerance_mm));
  }
  return sweep;
}

const std::vector<Sweep>& sweeps() {
  static const std::vector<Sweep> kSweeps = [] {
    std::vector<Sweep> all;
    for (const Kind& kind : kinds()) {
      for (const MotionModel model : kModels) {
        for (const double tolerance : kTolerances) all.push_back(sweep_of(kind, model, tolerance));
      }
    }
    return all;
  }();
  return kSweeps;
}

Finding sweeps_are_within_the_tolerance() {
  double share = 0, exact = 0;
  for (std::size_t n = 0; n < sweeps().size(); ++n) {
    share = std::max(share, sweeps()[n].error_mm / kTolerances[n % kTolerances.size()]);
    const std::size_t kind = n / (kModels.size() * kTolerances.size());
    if (kind == 0 || kind == 2) exact = std::max(exact, sweeps()[n].error_mm);
  }
  return {
      share <= 1.001 && exact < 1e-6,
      text("11 tools, 4 kinds of motion, 2 models, 2 tolerances: at most %.2f of the tolerance; "
           "without a turn below 1e-6 mm",
           share)};
}

Finding the_tight_model_needs_fewer_cuts() {
  const Sweep* both = &sweeps()[(kinds().size() - 1) * kModels.size() * kTolerances.size()];
  const double paper = both[1].cuts / both[0].cuts, tight = both[3].cuts / both[2].cuts;
  return {
      paper > 9 && tight < 4,
      text("a tenth of the tolerance takes %.0f times the cuts by the paper's model, %.1f times "
           "by the tight one",
           paper, tight)};
}

}  // namespace

Sculpture columns_cut_at(double height_mm) {
  SculptureSettings settings{.stock = BoxStock{{0, 0, 0}, {20, 8, kBlockHeightMm}}, .pitch_mm = 2};
  Sculpture block = block_of(settings, BallShape{kWideBallMm, 40});
  const Vec3 axis{0, -1, 0};
  block.apply(MoveTool{1, {{10, -4, height_mm}, axis}, {{10, 14, height_mm}, axis}}).value();
  return block;
}

std::string kinds_table() {
  std::string table =
      "| kind of motion | model | error / tolerance at 0.1, 0.01 mm | cuts of a "
      "motion |\n|---|---|---|---|\n";
  std::size_t n = 0;
  for (const Kind& kind : kinds()) {
    for (const MotionModel model : kModels) {
      table += text("| %s | %s |", kind.name, model == MotionModel::kPaper ? "paper" : "tight");
      for (std::size_t k = 0; k < kTolerances.size(); ++k) {
        table += text("%s %.2f", k > 0 ? "," : "", sweeps()[n + k].error_mm / kTolerances[k]);
      }
      table += " |";
      for (std::size_t k = 0; k < kTolerances.size(); ++k)
        table += text("%s %.1f", k > 0 ? "," : "", sweeps()[n + k].cuts);
      table += " |\n";
      n += kTolerances.size();
    }
  }
  return table;
}

std::string kinds_times(int rounds) {
  std::string table =
      "| kind of motion | tolerance | paper's model | tight model | ratio |\n"
      "|---|---|---|---|---|\n";
  const auto seconds = [](const Kind& kind, MotionModel model, double tolerance) {
    SculptureSettings settings = test::block(40, 16, 0.5, tolerance);
    settings.motion = model;
    settings.keep_normals = false;
    std::clock_t sum = 0;
    for (const test::NamedTool& tool : test::every_tool()) {
      test::Carving carving(settings, tool.tool);
      const std::clock_t begin = std::clock();
      carving.move(kind.from, kind.to);
      sum += std::clock() - begin;
    }
    return double(sum) / CLOCKS_PER_SEC;
  };
  for (const Kind& kind : kinds()) {
    for (const double tolerance : kTolerances) {
      double paper = HUGE_VAL, tight = HUGE_VAL;
      for (int n = 0; n < rounds; ++n) {
        paper = std::min(paper, seconds(kind, MotionModel::kPaper, tolerance));
        tight = std::min(tight, seconds(kind, MotionModel::kTight, tolerance));
      }
      table += text("| %s | %g mm | %.1f ms | %.1f ms | %.2f |\n", kind.name, tolerance,
                    1e3 * paper, 1e3 * tight, paper / tight);
    }
  }
  return table;
}

std::vector<Check> volume_checks() {
  return {{"DexelsAreShortenedAndBroken", dexels_are_shortened_and_broken},
          {"ConesLeaveTheirCuttingProfile", cones_leave_their_cutting_profile},
          {"SweepsAreWithinTheTolerance", sweeps_are_within_the_tolerance},
          {"TheTightModelNeedsFewerCuts", the_tight_model_needs_fewer_cuts}};
}

}  // namespace kerf::paper
