// SPDX-License-Identifier: Apache-2.0
// Measures the distance of dexel ends from the true swept surface, and the number of sub-motions,
// for every tool shape and tolerance. Usage: endpoint_bench [moves=60]

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <string>

#include "tests/kernel/extremes/carving.h"
#include "tests/support/standard_job.h"

namespace {

using namespace kerf;

constexpr double kDegree = std::numbers::pi / 180;

struct Figures {
  double max_mm = 0, overcut_mm = 0, squares = 0, sub_motions = 0, moves = 0;
  double ends = 0;

  void add(test::Carving& carving, double sub_motions_made, double moves_made, int columns,
           double interest_mm, unsigned seed) {
    max_mm = std::max(max_mm, carving.error_mm(columns, interest_mm, seed));
    overcut_mm = std::max(overcut_mm, carving.overcut_mm());
    squares += carving.rms_mm() * carving.rms_mm() * double(carving.ends_judged());
    ends += double(carving.ends_judged());
    sub_motions += sub_motions_made;
    moves += moves_made;
  }
  double rms_mm() const { return ends > 0 ? std::sqrt(squares / ends) : 0; }
};

/// Carves one motion in its own block and measures it alone.
void judge(Figures& figures, const Tool& tool, double tolerance, const ToolPose& from,
           const ToolPose& to, unsigned seed) {
  test::Carving carving(test::block(44, 20, 0.9, tolerance), tool);
  const MotionResult r = carving.move(from, to);
  figures.add(carving, r.sub_motions, 1, 30, 20 * tolerance, seed);
}

/// A move as in the standard job: 1 mm along the path, 2.5 degrees about a random axis.
Figures standard_moves(const Tool& tool, double tolerance, int moves) {
  std::mt19937_64 random(1);
  const auto in = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  Figures figures;
  for (int k = 0; k < moves; ++k) {
    const ToolPose a = test::leaning({in(-1, 1), in(-1, 1), -5}, in(0, 0.35), in(0, 6.2));
    const double heading = in(0, 6.2);
    const Vec3 about{in(-1, 1), in(-1, 1), in(-1, 1)};
    judge(figures, tool, tolerance, a,
          {a.tip_mm + Vec3{std::cos(heading), std::sin(heading), 0},
           test::turned(a.axis, about, 2.5 * kDegree)},
          unsigned(k));
  }
  return figures;
}

/// A program block that turns the tool by 170 degrees about points on its axis and off it.
Figures large_turns(const Tool& tool, double tolerance, int moves) {
  std::mt19937_64 random(2);
  const auto in = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  Figures figures;
  for (int k = 0; k < moves; ++k) {
    const ToolPose a = test::leaning({in(-1, 1), in(-1, 1), in(-9, -2)}, in(0, 1.4), in(0, 6.2));
    const Vec3 about{in(-1, 1), in(-1, 1), in(-1, 1)};
    const Vec3 u = test::turned(a.axis, about, 169.9 * kDegree);
    const double pivot = k % 4 == 0 ? 0 : in(-10, 40);
    const Vec3 aside = k % 4 == 3 ? Vec3{in(-5, 5), in(-5, 5), in(-3, 3)} : Vec3{};
    judge(figures, tool, tolerance, a, {a.tip_mm + (a.axis - u) * pivot + aside, u}, unsigned(k));
  }
  return figures;
}

/// The first rows of the three-axis standard job, measured together.
Figures three_axes(const Tool& tool) {
  const std::vector<ToolPose> path = test::standard_path(false);
  test::Carving carving(test::standard_settings(0.5, 1e-3), tool);
  double sub_motions = 0;
  constexpr std::size_t kMoves = 310;
  for (std::size_t i = 1; i <= kMoves; ++i) {
    sub_motions += carving.move(path[i - 1], path[i]).sub_motions;
  }
  Figures figures;
  figures.add(carving, sub_motions, double(kMoves), 2, 0.1, 1);
  return figures;
}

}  // namespace

int main(int argc, char** argv) {
  const int moves = argc > 1 ? std::atoi(argv[1]) : 60;
  std::printf(
      "Distance of dexel ends from the true swept surface (mm). over: greatest distance from\n"
      "the true sweep of something that was removed.\n\n");
  std::printf("%-12s %9s | %39s | %39s\n", "", "", "1 mm and 2.5 degrees a move",
              "170 degrees in one block");
  std::printf("%-12s %9s | %9s %9s %9s %9s | %9s %9s %9s %9s\n", "tool", "tolerance", "max", "over",
              "rms", "sub/move", "max", "over", "rms", "sub/move");
  bool within = true;
  for (const test::NamedTool& t : test::every_tool()) {
    for (const double tolerance : {0.1, 0.01, 0.001, 0.0001}) {
      const Figures a = standard_moves(t.tool, tolerance, moves);
      const Figures b = large_turns(t.tool, tolerance, std::max(1, moves / 5));
      const bool good = std::max(a.max_mm, b.max_mm) <= tolerance + 1e-7;
      within = within && good;
      std::printf("%-12s %9g | %9.2e %9.2e %9.2e %9.2f | %9.2e %9.2e %9.2e %9.1f%s\n",
                  t.name.c_str(), tolerance, a.max_mm, a.overcut_mm, a.rms_mm(),
                  a.sub_motions / a.moves, b.max_mm, b.overcut_mm, b.rms_mm(),
                  b.sub_motions / b.moves, good ? "" : "  BEYOND");
    }
  }
  std::printf("\nThree axes, standard job (target: 2e-6):\n");
  for (const test::NamedTool& t : test::every_tool()) {
    const Figures f = three_axes(t.tool);
    std::printf("%-12s max %.2e rms %.2e, %.0f ends\n", t.name.c_str(), f.max_mm, f.rms_mm(),
                f.ends);
  }
  std::printf("\n%s\n", within ? "Every end is within its tolerance."
                               : "Some ends are beyond their tolerance.");
  return 0;
}
