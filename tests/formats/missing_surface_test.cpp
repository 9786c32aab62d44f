// SPDX-License-Identifier: Apache-2.0
// Surface missing from the mesh counts as error: errors are also measured from the true surface to
// the mesh, and walls that may fall between the rays are found from the swept shapes.
#include "server/carve/surface_error.h"
#include "server/verify/thin_walls.h"
#include "tests/support/standard_job.h"
#include "tests/support/test.h"

namespace kerf::missing_surface_test {
namespace {

constexpr double kPitchMm = 0.3, kRibMm = 0.14, kToolMm = 3, kDepthMm = 4;
constexpr std::size_t kSamples = 1500;
const BoxStock kBlock{{0, 0, 0}, {30, 30, 10}};

struct Job {
  std::map<ToolId, SceneTool> tools;
  std::vector<ProgramMotion> motions;
  TrueSolid truth;

  Job(const ToolShape& shape, std::vector<ProgramMotion> of)
      : tools{{1, SceneTool{.shape = shape, .body = {}, .tool = make_tool(shape).value()}}},
        motions(std::move(of)),
        truth(kBlock, tools, motions, 4) {}
};

ProgramMotion motion(const ToolPose& from, const ToolPose& to) {
  return {1, from, to, 1, 0, false};
}

// Two slots through the block with a rib between them, whose middle is `middle`.
Job two_slots(Vec3 along, Vec3 middle, double rib_mm = kRibMm) {
  const Vec3 half = Vec3{-along.y, along.x, 0} * ((kToolMm + rib_mm) / 2);
  const Vec3 floor{middle.x, middle.y, 10 - kDepthMm}, far = along * 40;
  return {FlatShape{kToolMm, 30},
          {motion({floor + half - far}, {floor + half + far}),
           motion({floor - half - far}, {floor - half + far})}};
}
const double kHalf = std::sqrt(0.5);
// Columns are at odd multiples of 0.15 mm. The rib along x spans 14.93 to 15.07. The diagonal one
// is between two diagonals of columns, 0.212 mm apart.
Job rib_along_x() { return two_slots({1, 0, 0}, {15, 15, 0}); }
Job diagonal_rib() { return two_slots({kHalf, kHalf, 0}, {15, 15.15, 0}); }

SolidSnapshot carve(const Job& job, Rays rays = Rays::kDexel) {
  Sculpture sculpture = Sculpture::create({.stock = kBlock,
                                           .rays = rays,
                                           .pitch_mm = kPitchMm,
                                           .tolerance_mm = 0.001,
                                           .keep_normals = true})
                            .value();
  for (const auto& [id, tool] : job.tools) sculpture.apply(DefineTool{id, tool.tool}).value();
  for (const ProgramMotion& m : job.motions)
    sculpture.apply(MoveTool{m.tool, m.from, m.to, m.duration_s, false}).value();
  return sculpture.solid();
}

double missing_mm(const Job& job, Rays rays = Rays::kDexel) {
  return measure_missing(carve(job, rays), sample_cut_surface(job.truth, kSamples)).max_mm;
}

std::vector<ThinWall> walls_of(const Job& job) {
  return find_thin_walls(job.truth, sample_cut_surface(job.truth, kSamples), {kPitchMm, 0.001});
}
std::vector<ThinWall> grooves_of(const Job& job) {
  auto walls = walls_of(job);
  std::erase_if(walls, [](const ThinWall& wall) { return !wall.groove; });
  return walls;
}
Job groove(double width_mm, double y) {
  return {FlatShape{width_mm, 30}, {motion({{-5, y, 6}}, {{35, y, 6}})}};
}

TEST(CutSurface, PointsAreOnTheTrueSurface) {
  const Job job(BallShape{6, 30}, {motion({{5, 5, 6}}, {{25, 20, 5}, normalized({0.3, 0.2, 1})}),
                                   motion({{25, 20, 5}, normalized({0.3, 0.2, 1})}, {{8, 20, 7}})});
  const CutSurface surface = sample_cut_surface(job.truth, kSamples);
  EXPECT_GT(surface.points.size(), kSamples / 10);
  EXPECT_GT(surface.spacing_mm, 0.1);
  for (const CutPoint& point : surface.points) {
    const auto distance = job.truth.distance(point.mm);
    EXPECT_LT(distance.mm, 1e-3);
    EXPECT_FALSE(job.truth.is_clear(point.mm - point.into_solid * 0.01, 0));
    EXPECT_TRUE(job.truth.is_clear(point.mm + point.into_solid * 1e-4, 0));
  }
}

TEST(CutSurface, EqualSolidsGiveEqualPoints) {
  const auto a = sample_cut_surface(diagonal_rib().truth, 300);
  const auto b = sample_cut_surface(diagonal_rib().truth, 300);
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t n = 0; n < a.points.size(); ++n) EXPECT_EQ(a.points[n].mm, b.points[n].mm);
}

TEST(MissingSurface, MissedRibIsAnErrorOfItsHeight) {
  for (const Job& job : {rib_along_x(), diagonal_rib()}) {
    for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
      // The distance from the mesh to the solid hides the loss, because the floor is near the rib's
      // foot.
      EXPECT_LT(measure_surface(carve(job, rays), job.truth, kSamples).max_mm, 0.15);
      EXPECT_GT(missing_mm(job, rays), 2);
    }
  }
}

TEST(MissingSurface, RibHitByRaysHasASmallError) {
  EXPECT_LT(missing_mm(two_slots({1, 0, 0}, {15, 14.85, 0})), kPitchMm);
  EXPECT_LT(missing_mm(two_slots({1, 0, 0}, {15, 15, 0}, 0.9)), kPitchMm);
  EXPECT_LT(missing_mm(two_slots({1, 0, 0}, {15, 15, 0}, 0.9), Rays::kTriDexel), 0.01);
}

TEST(MissingSurface, MissedGrooveIsAnErrorOfItsDepth) {
  const Job job = groove(0.14, 15);
  EXPECT_EQ(measure_surface(carve(job), job.truth, kSamples).samples, 0u);
  EXPECT_GT(missing_mm(job), 3.5);
}

TEST(ThinWalls, RibIsFoundWithPlaceAndBothCuts) {
  for (const Job& job : {rib_along_x(), diagonal_rib()}) {
    auto walls = walls_of(job);
    ASSERT_FALSE(walls.empty());
    for (const ThinWall& wall : walls) {
      EXPECT_NEAR(wall.thickness_mm, kRibMm, 1e-4);
      EXPECT_EQ(wall.sweep + wall.other_sweep, 1u);
      EXPECT_NEAR(job.truth.from_cuts(wall.mm).mm, kRibMm / 2, 1e-4);
    }
    EXPECT_EQ(distinct_walls(walls, {7, 9}, kPitchMm).size(), 1u);
    mark_missing(walls, carve(job).fields.front());
    for (const ThinWall& wall : walls) EXPECT_TRUE(wall.missing);
  }
}

TEST(ThinWalls, RibHitByAColumnIsNotMissing) {
  const Job job = two_slots({1, 0, 0}, {15, 14.85, 0});
  auto walls = walls_of(job);
  mark_missing(walls, carve(job).fields.front());
  ASSERT_FALSE(walls.empty());
  for (const ThinWall& wall : walls) EXPECT_FALSE(wall.missing);
}

TEST(ThinWalls, WallAtTheBorderOfTheStockIsFound) {
  const Job job(FlatShape{kToolMm, 30}, {motion({{-5, 1.64, 6}}, {{35, 1.64, 6}})});
  const auto walls = walls_of(job);
  ASSERT_FALSE(walls.empty());
  EXPECT_NEAR(walls[0].thickness_mm, 0.14, 1e-4);
  EXPECT_EQ(walls[0].other_sweep, 1u);
}

TEST(ThinWalls, ThickWallsRidgesAndFloorsAreNotReported) {
  EXPECT_TRUE(walls_of(two_slots({1, 0, 0}, {15, 15, 0}, 0.33)).empty());
  EXPECT_TRUE(walls_of(two_slots({kHalf, kHalf, 0}, {15, 15.15, 0}, 0.33)).empty());
  // Two parallel ball passes leave a blunt ridge.
  EXPECT_TRUE(walls_of(Job(BallShape{6, 30}, {motion({{-5, 13, 7}}, {{35, 13, 7}}),
                                              motion({{-5, 17, 7}}, {{35, 17, 7}})}))
                  .empty());
  // A horizontal web of 0.14 mm: every ray along Z hits it.
  const Vec3 lying{0, -1, 0};
  EXPECT_TRUE(walls_of(Job(FlatShape{kToolMm, 30},
                           {motion({{-5, 10, 5}, lying}, {{35, 10, 5}, lying}),
                            motion({{-5, 10, 8.14}, lying}, {{35, 10, 8.14}, lying})}))
                  .empty());
}

TEST(ThinWalls, FilmsBelowTheToleranceAreIgnored) {
  const Job job = two_slots({1, 0, 0}, {15, 15, 0}, 0.004);
  const CutSurface surface = sample_cut_surface(job.truth, kSamples);
  EXPECT_FALSE(find_thin_walls(job.truth, surface, {kPitchMm, 0.001}).empty());
  EXPECT_TRUE(find_thin_walls(job.truth, surface, {kPitchMm, 0.01}).empty());
}

TEST(NarrowGrooves, GrooveIsFoundWithItsPlaceAndIsMissing) {
  const Job job = groove(0.14, 15);
  auto walls = walls_of(job);
  ASSERT_FALSE(walls.empty());
  for (const ThinWall& wall : walls) {
    EXPECT_TRUE(wall.groove);
    EXPECT_NEAR(wall.thickness_mm, 0.14, 1e-4);
    EXPECT_NEAR(wall.mm.y, 15, 1e-4);
    EXPECT_EQ(wall.sweep, 0u);
    EXPECT_EQ(wall.other_sweep, 0u);
  }
  mark_missing(walls, carve(job).fields.front());
  for (const ThinWall& wall : walls) EXPECT_TRUE(wall.missing);
}

TEST(NarrowGrooves, GrooveHitByAColumnIsNotMissing) {
  const Job job = groove(0.14, 14.85);
  auto walls = walls_of(job);
  mark_missing(walls, carve(job).fields.front());
  ASSERT_FALSE(walls.empty());
  for (const ThinWall& wall : walls) EXPECT_FALSE(wall.missing);
}

TEST(NarrowGrooves, NarrowHoleIsFound) {
  const auto walls = grooves_of(Job(FlatShape{0.2, 30}, {motion({{15, 15, 12}}, {{15, 15, 6}})}));
  ASSERT_FALSE(walls.empty());
  EXPECT_NEAR(walls[0].thickness_mm, 0.2, 1e-3);
}

TEST(NarrowGrooves, WideShallowAndHorizontalGroovesAreNotReported) {
  EXPECT_TRUE(grooves_of(groove(0.33, 15)).empty());
  EXPECT_TRUE(grooves_of(Job(BallShape{6, 30}, {motion({{-5, 15, 8}}, {{35, 15, 8}})})).empty());
  // 0.1 mm deep: the air above is within a pitch.
  EXPECT_TRUE(
      grooves_of(Job(FlatShape{0.14, 30}, {motion({{-5, 15, 9.9}}, {{35, 15, 9.9}})})).empty());
  // A pocket widened by a thin tool to 0.4 mm.
  std::vector<ProgramMotion> rows;
  for (const double y : {15.0, 15.1, 15.2, 15.26})
    rows.push_back(motion({{-5, y, 6}}, {{35, y, 6}}));
  EXPECT_TRUE(grooves_of(Job(FlatShape{0.14, 30}, rows)).empty());
  // A horizontal groove of 0.14 mm: every ray along Z hits it.
  const Vec3 lying{0, -1, 0};
  EXPECT_TRUE(
      grooves_of(Job(FlatShape{0.14, 30}, {motion({{-5, 10, 5}, lying}, {{35, 10, 5}, lying})}))
          .empty());
}

TEST(NarrowGrooves, GrooveDeterminesThePitchForATarget) {
  const auto pitch_of = [](const Job& job) {
    return pitch_for_walls(job.truth, sample_cut_surface(job.truth, kSamples),
                           {kPitchMm, kPitchMm, 0.001});
  };
  const auto pitch = test::value_of(pitch_of(groove(0.14, 15)));
  EXPECT_LE(pitch, 0.14 * 1.02);
  EXPECT_GT(pitch, 0.14 / 1.2);
  EXPECT_EQ(pitch_of(groove(0.9, 15)), kPitchMm);
}

TEST(NarrowGrooves, GrooveOfASmallToolIsFoundAmongWidePockets) {
  std::map<ToolId, SceneTool> tools;
  for (const auto& [id, mm] : {std::pair{1, 6.0}, {2, 0.14}}) {
    const ToolShape shape = FlatShape{mm, 30};
    tools[ToolId(id)] = {.shape = shape, .body = {}, .tool = make_tool(shape).value()};
  }
  std::vector<ProgramMotion> motions;
  for (double y = 0; y <= 26; y += 1) motions.push_back(motion({{-5, y, 6}}, {{35, y, 6}}));
  motions.push_back({2, {{15, 29.7, 9}}, {{15.5, 29.7, 9}}, 1, 0, false});
  const TrueSolid truth(kBlock, tools, motions, 4);
  const auto walls = find_thin_walls(truth, sample_cut_surface(truth, kSamples), {kPitchMm, 0.001});
  ASSERT_FALSE(walls.empty());
  EXPECT_TRUE(walls[0].groove);
  EXPECT_EQ(walls[0].sweep, motions.size() - 1);
}

TEST(ThinWalls, RibDeterminesThePitchForATarget) {
  const auto pitch_of = [](const Job& job) {
    return pitch_for_walls(job.truth, sample_cut_surface(job.truth, kSamples),
                           {kPitchMm, kPitchMm, 0.001});
  };
  const auto pitch = test::value_of(pitch_of(rib_along_x()));
  EXPECT_LE(pitch, kRibMm * 1.02);
  EXPECT_GT(pitch, kRibMm / 1.2);
  EXPECT_EQ(pitch_of(two_slots({1, 0, 0}, {15, 15, 0}, 0.9)), kPitchMm);
  // Less than an eighth of the pitch.
  EXPECT_FALSE(pitch_of(two_slots({1, 0, 0}, {15, 15, 0}, 0.004)).has_value());
}

}  // namespace
}  // namespace kerf::missing_surface_test
