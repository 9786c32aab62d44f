// SPDX-License-Identifier: Apache-2.0
// Paths that clear pockets, slots, studs and faces: every point of a raster is either cut or not.
#include "server/formats/control/area_path.h"

#include "tests/support/test.h"

namespace kerf::area_path_test {
namespace {

struct Segment {
  double ax, ay, bx, by;
};

/// The segments of a path; an arc is sampled.
std::vector<Segment> segments_of(const AreaPath& path) {
  std::vector<Segment> segments;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const AreaMove &a = path[i - 1], &b = path[i];
    if (b.turns == 0) {
      segments.push_back({a.x, a.y, b.x, b.y});
      continue;
    }
    const double radius = std::hypot(b.x - b.center_x, b.y - b.center_y);
    EXPECT_NEAR(std::hypot(a.x - b.center_x, a.y - b.center_y), radius, 1e-9);
    const double from = std::atan2(a.y - b.center_y, a.x - b.center_x);
    double sweep = std::atan2(b.y - b.center_y, b.x - b.center_x) - from;
    while (b.turns * sweep <= 1e-9) sweep += b.turns * 2 * std::numbers::pi;
    constexpr int kChords = 64;
    for (int n = 0; n < kChords; ++n) {
      const double p = from + sweep * n / kChords, q = from + sweep * (n + 1) / kChords;
      segments.push_back({b.center_x + radius * std::cos(p), b.center_y + radius * std::sin(p),
                          b.center_x + radius * std::cos(q), b.center_y + radius * std::sin(q)});
    }
  }
  return segments;
}

double distance_from(const std::vector<Segment>& segments, double x, double y) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [ax, ay, bx, by] : segments) {
    const double dx = bx - ax, dy = by - ay, size = dx * dx + dy * dy;
    const double t = size > 0 ? std::clamp(((x - ax) * dx + (y - ay) * dy) / size, 0.0, 1.0) : 0;
    least = std::min(least, std::hypot(ax + t * dx - x, ay + t * dy - y));
  }
  return least;
}

// Every point inside a shape is cut, and no point outside. `depth` is the distance into the shape.
void expect_cut(const AreaPath& path, double tool, double reach,
                const std::function<double(double, double)>& depth) {
  const std::vector<Segment> segments = segments_of(path);
  const double margin = 0.02;
  for (double x = -reach; x <= reach; x += 0.173)
    for (double y = -reach; y <= reach; y += 0.191) {
      const double in = depth(x, y);
      if (std::abs(in) < margin) continue;
      const bool cut = distance_from(segments, x, y) <= tool + 0.01;
      ASSERT_EQ(cut, in > 0) << x << " " << y;
    }
}

double in_rectangle(double x, double y, double length, double width, double corner) {
  const double dx = std::abs(x) - (length / 2 - corner), dy = std::abs(y) - (width / 2 - corner);
  if (dx > 0 && dy > 0) return corner - std::hypot(dx, dy);
  return corner - std::max(dx, dy);
}

TEST(AreaPath, PocketsAreClearedToTheirWallsAndNoFurther) {
  for (const double step : {0.5, 2.0, 9.0})
    for (const auto& [length, width, corner] :
         {std::array{20.0, 12.0, 3.0}, std::array{12.0, 20.0, 0.0}, std::array{20.0, 20.0, 10.0},
          std::array{18.0, 4.0, 2.0}, std::array{17.0, 9.0, 4.5}}) {
      const auto path = test::value_of(clear_pocket({length, width, corner}, 2, step));
      const double rounded = std::max(corner, 2.0);
      expect_cut(path, 2, 11, [&, l = length, w = width](double x, double y) {
        return in_rectangle(x, y, l, w, rounded);
      });
    }
}

TEST(AreaPath, StudsRemainInTheirBlank) {
  const auto segments = segments_of(test::value_of(mill_stud({10, 6, 1}, {16, 14, 0}, 2, 1.5)));
  for (double x = -8; x <= 8; x += 0.173)
    for (double y = -7; y <= 7; y += 0.191) {
      const double in = in_rectangle(x, y, 10, 6, 1);
      if (std::abs(in) < 0.02) continue;
      ASSERT_EQ(distance_from(segments, x, y) <= 2.01, in < 0) << x << " " << y;
    }
}

TEST(AreaPath, SlotsFollowTheirArc) {
  const auto path = test::value_of(
      clear_arc_slot({.radius = 8, .width = 5, .first_deg = 20, .sweep_deg = 130}, 1, 1));
  expect_cut(path, 1, 12, [](double x, double y) {
    double angle = std::atan2(y, x) * 180 / std::numbers::pi;
    if (angle < -90) angle += 360;
    const double rad = std::numbers::pi / 180;
    if (angle >= 20 && angle <= 150) return 2.5 - std::abs(std::hypot(x, y) - 8);
    return 2.5 - std::min(std::hypot(x - 8 * std::cos(20 * rad), y - 8 * std::sin(20 * rad)),
                          std::hypot(x - 8 * std::cos(150 * rad), y - 8 * std::sin(150 * rad)));
  });
}

TEST(AreaPath, FacesAreCoveredByTheirStrokes) {
  const auto path = test::value_of(face(20, -13, true, 3, 5));
  const auto segments = segments_of(path);
  for (double x = 0; x <= 20; x += 0.7)
    for (double y = -13; y <= 0; y += 0.7) EXPECT_LE(distance_from(segments, x, y), 3);
  EXPECT_EQ(path.front().x, 0);
}

TEST(AreaPath, RejectsAreasThatTheToolCannotCut) {
  EXPECT_FALSE(clear_pocket({10, 3, 0}, 2, 1));
  EXPECT_FALSE(clear_pocket({10, 9, 0}, 0, 1));
  EXPECT_FALSE(clear_pocket({1e6, 1e6, 0}, 0.1, 0.1));
  EXPECT_FALSE(mill_stud({10, 10, 0}, {9, 9, 0}, 2, 1));
  EXPECT_FALSE(clear_arc_slot({.radius = 2, .width = 5, .sweep_deg = 30}, 1, 1));
  EXPECT_FALSE(face(10, 10, true, 2, 0));
}

TEST(AreaPath, PassesAreEqualAndEndAtTheBottom) {
  EXPECT_EQ(pass_levels(1, -5, 2.5), (std::vector<double>{-1, -3, -5}));
  EXPECT_EQ(pass_levels(0, -5, 0), (std::vector<double>{-5}));
  EXPECT_EQ(pass_levels(0, -5, 9), (std::vector<double>{-5}));
}

TEST(AreaPath, TheLastLoopIsTheWall) {
  const auto pocket = test::value_of(clear_pocket({20, 20, 3}, 2, 1));
  const AreaPath wall = last_loop(pocket);
  EXPECT_LT(wall.size(), pocket.size());
  double most = 0, least = 100;
  for (const AreaMove& move : wall) {
    most = std::max(most, std::abs(move.x));
    least = std::min(least, std::max(std::abs(move.x), std::abs(move.y)));
  }
  EXPECT_NEAR(most, 8, 1e-9);
  EXPECT_GT(least, 7);
}

}  // namespace
}  // namespace kerf::area_path_test
