// SPDX-License-Identifier: Apache-2.0
// Pockets within an outline: the cut of the loop and the strokes, against all positions of the
// tool.
#include "server/formats/gcode/outline_pocket.h"

#include "tests/formats/dialect_runs.h"
#include "tests/support/test.h"

namespace kerf::outline_pocket_test {
namespace {

using test::haas;
using test::refused;
using testing::HasSubstr;

double distance_of(double x, double y, double ax, double ay, double bx, double by) {
  const double dx = bx - ax, dy = by - ay, size = dx * dx + dy * dy;
  const double t = size > 0 ? std::clamp(((x - ax) * dx + (y - ay) * dy) / size, 0.0, 1.0) : 0;
  return std::hypot(ax + t * dx - x, ay + t * dy - y);
}

// The path as chords, 120 of each arc.
std::vector<OutlinePoint> chords_of(const AreaPath& path) {
  std::vector<OutlinePoint> points{{path.front().x, path.front().y}};
  for (std::size_t i = 1; i < path.size(); ++i) {
    const AreaMove &a = path[i - 1], &b = path[i];
    if (b.turns != 0) {
      const double from = std::atan2(a.y - b.center_y, a.x - b.center_x);
      double sweep = std::atan2(b.y - b.center_y, b.x - b.center_x) - from;
      while (b.turns * sweep <= 1e-9) sweep += b.turns * 2 * std::numbers::pi;
      const double radius = std::hypot(b.x - b.center_x, b.y - b.center_y);
      for (int n = 1; n < 120; ++n)
        points.push_back({b.center_x + radius * std::cos(from + sweep * n / 120),
                          b.center_y + radius * std::sin(from + sweep * n / 120)});
    }
    points.push_back({b.x, b.y});
  }
  return points;
}

double distance_to(const std::vector<OutlinePoint>& points, double x, double y) {
  double least = HUGE_VAL;
  for (std::size_t i = 1; i < points.size(); ++i)
    least = std::min(least,
                     distance_of(x, y, points[i - 1].x, points[i - 1].y, points[i].x, points[i].y));
  return least;
}

bool is_inside(const std::vector<OutlinePoint>& points, double x, double y) {
  double turned = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double ax = points[i - 1].x - x, ay = points[i - 1].y - y;
    const double bx = points[i].x - x, by = points[i].y - y;
    turned += std::atan2(ax * by - ay * bx, ax * bx + ay * by);
  }
  return std::abs(turned) > 3;
}

AreaPath turned(AreaPath path, double turn_deg) { return placed(std::move(path), 1, -2, turn_deg); }

AreaPath reversed(const AreaPath& path) {
  AreaPath back{{.x = path.back().x, .y = path.back().y}};
  for (std::size_t i = path.size() - 1; i > 0; --i) {
    AreaMove move = path[i];
    move.x = path[i - 1].x;
    move.y = path[i - 1].y;
    move.turns = -move.turns;
    back.push_back(move);
  }
  return back;
}

const AreaPath kNotched{{.x = -10, .y = 4},
                        {.x = -10, .y = -8},
                        {.x = -2, .y = -8},
                        {.x = -2, .y = -1},
                        {.x = 2, .y = -1, .turns = -1, .center_x = 0, .center_y = -1},
                        {.x = 2, .y = -8},
                        {.x = 10, .y = -8},
                        {.x = 10, .y = 4, .turns = 1, .center_x = 10, .center_y = -2},
                        {.x = -10, .y = 4}};
const AreaPath kTriangle{{.x = 0, .y = -9}, {.x = 9, .y = 8}, {.x = -9, .y = 6}, {.x = 0, .y = -9}};
const AreaPath kCircle{
    {.x = 7, .y = 0}, {.x = -7, .y = 0, .turns = 1}, {.x = 7, .y = 0, .turns = 1}};
const AreaPath kLetter{{.x = 0, .y = 8},  {.x = -9, .y = 8}, {.x = -9, .y = -8}, {.x = 9, .y = -8},
                       {.x = 9, .y = -2}, {.x = 0, .y = -2}, {.x = 0, .y = 8}};

// Expects a cut of exactly the points that the tool reaches from positions within the outline.
void expect_cleared(const AreaPath& outline, double radius, double step, bool along_x) {
  const OutlinePocket pocket(outline, radius);
  const auto strokes = test::value_of(pocket.strokes(step, along_x));
  const std::vector<OutlinePoint> wall = chords_of(outline), loop = chords_of(pocket.loop());
  std::vector<OutlinePoint> places;  // the outermost positions
  for (double x = -20; x <= 20; x += 0.11)
    for (double y = -20; y <= 20; y += 0.11)
      if (const double off = distance_to(wall, x, y);
          off >= radius && off < radius + 0.25 && is_inside(wall, x, y))
        places.push_back({x, y});
  ASSERT_FALSE(places.empty());
  for (double x = -18; x <= 18; x += 0.377)
    for (double y = -18; y <= 18; y += 0.391) {
      const bool is_place = is_inside(wall, x, y) && distance_to(wall, x, y) >= radius;
      double to_place = is_place ? 0 : HUGE_VAL, to_path = distance_to(loop, x, y);
      for (const OutlinePoint& place : places)
        to_place = std::min(to_place, std::hypot(place.x - x, place.y - y));
      for (const auto& [from, to] : strokes)
        to_path = std::min(to_path, distance_of(x, y, from.x, from.y, to.x, to.y));
      if (std::abs(to_place - radius) < 0.15) continue;
      ASSERT_EQ(to_path <= radius + 0.005, to_place < radius) << x << " " << y;
    }
}

TEST(OutlinePocket, IsClearedToItsOutlineAndNoFurther) {
  for (const AreaPath& outline : {kNotched, kTriangle, kCircle, kLetter}) {
    expect_cleared(outline, 1.5, 1, true);
    expect_cleared(reversed(turned(outline, 33)), 1.5, 2.9, false);
  }
}

TEST(OutlinePocket, StrokesStayClearOfTheOutline) {
  for (const AreaPath& outline : {kNotched, kTriangle, kCircle, kLetter}) {
    const OutlinePocket pocket(outline, 1.25);
    const std::vector<OutlinePoint> wall = chords_of(outline);
    for (const bool along_x : {true, false}) {
      const auto strokes = test::value_of(pocket.strokes(0.7, along_x));
      for (const auto& [from, to] : strokes) {
        EXPECT_TRUE(pocket.is_clear(from, to));
        for (const double s : {0.0, 0.3, 1.0}) {
          const double x = std::lerp(from.x, to.x, s), y = std::lerp(from.y, to.y, s);
          EXPECT_TRUE(is_inside(wall, x, y));
          EXPECT_GE(distance_to(wall, x, y), 1.25);
        }
      }
    }
  }
  const OutlinePocket pocket(kLetter, 1);
  EXPECT_FALSE(pocket.is_clear({-1, 6}, {7, -3.5}));  // across the corner
  EXPECT_FALSE(pocket.is_clear({-8.5, 0}));
  EXPECT_FALSE(pocket.is_clear({-20, 0}));
  EXPECT_FALSE(pocket.strokes(0.001, true));
  EXPECT_TRUE(OutlinePocket(kLetter, 20).strokes(1, true).value().empty());
}

const std::string kSquare = "M30\nO7\nG1 X0 Y-5\nX5\nY5\nX-5\nY-5\nX0\nM99\n";

std::string square(const std::string& words) {
  return "T1\nG0 X0 Y0 Z5\nF100\nG150 P7 " + words + "\nG0 Z9\n" + kSquare;
}

// D1 is a tool of radius 1. Reading the outline causes no motion. The loop begins next to the end
// of its first line. Strokes keep 0.001 mm more than the radius.
TEST(HaasG150, MillsWithinItsOutline) {
  EXPECT_EQ(haas(square("X0 Y0 Z-1. R1. Q5. J4. G41 D1")),
            "R 0 0 5, R 0 0 1, F 0 0 -1, F 4 -4 -1, F 4 4 -1, F -4 4 -1, F -4 -4 -1, F 0 -4 -1, "
            "F 4 -4 -1, F -3.999 0 -1, F 3.999 0 -1, R 3.999 0 1, R 3.999 0 9");
  EXPECT_THAT(haas(square("Z-1. R1. Q5. I4. G41 D1")),
              HasSubstr("F 4 -4 -1, F 0 -3.999 -1, F 0 3.999 -1, R 0 3.999 1"));
}

TEST(HaasG150, RoughsInPassesAndFinishesAtTheBottom) {
  EXPECT_EQ(haas(square("Z-1. R1. Q1. I9. K.5 G41 D1")),
            "R 0 0 5, R 0 0 1, F 0 0 0, F 3.5 -3.5 0, F 3.5 3.5 0, F -3.5 3.5 0, F -3.5 -3.5 0, "
            "F 0 -3.5 0, F 3.5 -3.5 0, R 3.5 -3.5 1, R 0 0 1, F 0 0 -1, F 3.5 -3.5 -1, "
            "F 3.5 3.5 -1, F -3.5 3.5 -1, F -3.5 -3.5 -1, F 0 -3.5 -1, F 3.5 -3.5 -1, F 4 -4 -1, "
            "F 4 4 -1, F -4 4 -1, F -4 -4 -1, F 0 -4 -1, F 4 -4 -1, R 4 -4 1, R 4 -4 9");
}

TEST(HaasG150, OutlineMayBeASequenceNumber) {
  const std::string words = "Z-1. R1. Q5. J9. G41 D1";
  EXPECT_EQ(haas("T1\nF9\nG150 P7 " + words + "\nM30\nN7 G1 Y-5\nX5\nY5\nX-5\nY-5\nX0\nM99\n"),
            haas("T1\nF9\nG150 P7 " + words + "\n" + kSquare));
}

// A square of 10 mm with rounded corners, around the tool of 2 mm.
TEST(HaasG150, RoundsAndCutsCornersOfItsOutline) {
  const std::string outline = "M30\nO7\nG1 Y-5\nX5 ,R3.\nY5 ,C2.\nX-5\nY-5\nX0\nM99\n";
  EXPECT_THAT(haas("T1\nF9\nG150 P7 Z-1. R1. Q5. I9. G41 D1\n" + outline),
              HasSubstr("F 2 -4 -1, A 4 -2 -1, F 4 2.585786438 -1, F 2.585786438 4 -1, F -4 4 -1"));
}

TEST(HaasG150, RejectsOutlinesThatCannotBeMilled) {
  const auto why = [](const std::string& program) { return refused(program, Dialect::kHaas); };
  EXPECT_THAT(why(square("Z-1. R1. Q5. J3. G42 D1")), HasSubstr("use G41"));
  EXPECT_THAT(why(square("X9. Z-1. R1. Q5. J3. G41 D1")), HasSubstr("does not fit"));
  EXPECT_THAT(why(square("Z-1. R1. Q5. G41 D1")), HasSubstr("requires I or J"));
  EXPECT_THAT(why(square("Z-1. R1. J3. G41 D1")), HasSubstr("requires Q"));
  EXPECT_THAT(why(square("Z3. R1. Q5. J3. G41 D1")), HasSubstr("below R"));
  EXPECT_THAT(why("T1\nF9\nG150 P7 Z-1. R1. Q5. J3. G41 D1\nM30\nO7\nG1 Y-5\nX5\nY5\nM99\n"),
              HasSubstr("not closed: it begins at X0 Y-5 and ends at X5 Y5"));
  EXPECT_THAT(why("T1\nF9\nG150 P7 Z-1. R1. Q5. J3. G41 D1\nM30\nO7\nG1 Y-5\nX5\nM30\n"),
              HasSubstr("no M99"));
  EXPECT_THAT(why("T1\nF9\nG150 P7 Z-1. R1. Q5. J3. G41 D1\nM30\nO7\nG1 Y-5\nZ-2\nM99\n"),
              HasSubstr("X and Y only"));
  EXPECT_THAT(why("T1\nF9\nG150 P7 Z-1. R1. Q5. J3. G41 D1\nM30\nO7\nG1 Y-5\nG18 X5\nM99\n"),
              HasSubstr("plane XY"));
  EXPECT_THAT(why("T1\nF9\nG150 P8 Z-1. R1. Q5. J3.\nM30\n"), HasSubstr("calls O8"));
  EXPECT_THAT(why("T1\nF9\nG91\nG150 P7 Z-1. R1. Q5. J3.\n" + kSquare), HasSubstr("G90"));
  EXPECT_THAT(why("T1\nF9\nG41 D1\nG150 P7 Z-1. R1. Q5. J3.\n" + kSquare), HasSubstr("G40"));
  EXPECT_THAT(refused("T1\nF9\nG150 P7 Z-1. R1. Q5. J3.\n" + kSquare), HasSubstr("'G150'"));
}

}  // namespace
}  // namespace kerf::outline_pocket_test
