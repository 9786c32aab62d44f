// SPDX-License-Identifier: Apache-2.0
// Walls and grooves of a mesh stock that are thinner than the pitch.
#include "kernel/dexel/mesh_stock.h"
#include "server/verify/stock_mesh.h"
#include "server/verify/thin_walls.h"
#include "tests/support/test.h"

namespace kerf::thin_stock_test {
namespace {

constexpr double kPitchMm = 0.3;
constexpr std::size_t kSamples = 2000;

// Appends a box to a mesh. Boxes may overlap.
void add_box(TriangleMesh& mesh, Vec3 low, Vec3 high) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices_mm.size());
  for (unsigned n = 0; n < 8; ++n)
    mesh.vertices_mm.push_back({(n & 1) != 0 ? high.x : low.x, (n & 2) != 0 ? high.y : low.y,
                                (n & 4) != 0 ? high.z : low.z});
  for (const auto& [a, b, c, d] : {std::array<std::uint32_t, 4>{0, 2, 3, 1},
                                   {4, 5, 7, 6},
                                   {0, 1, 5, 4},
                                   {2, 6, 7, 3},
                                   {0, 4, 6, 2},
                                   {1, 3, 7, 5}}) {
    mesh.triangles.push_back({first + a, first + b, first + c});
    mesh.triangles.push_back({first + a, first + c, first + d});
  }
}

// A base of 20 x 20 x 5 mm.
TriangleMesh base() {
  TriangleMesh mesh;
  add_box(mesh, {0, 0, 0}, {20, 20, 5});
  return mesh;
}
// The base with a fin 0.14 mm thick and 5 mm high, its middle at x = 9.9.
TriangleMesh with_fin() {
  TriangleMesh mesh = base();
  add_box(mesh, {9.83, 2, 4}, {9.97, 18, 10});
  return mesh;
}
// The base with two blocks on it, 0.14 mm apart at x = 9.9.
TriangleMesh with_gap() {
  TriangleMesh mesh = base();
  add_box(mesh, {2, 2, 4}, {9.83, 18, 10});
  add_box(mesh, {9.97, 2, 4}, {18, 18, 10});
  return mesh;
}
TriangleMesh inside_out(TriangleMesh mesh) {
  for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
  return mesh;
}

SculptureSettings settings_of(const TriangleMesh& mesh) {
  return SculptureSettings{.stock = mesh_bounds(mesh),
                           .stock_mesh = std::make_shared<const TriangleMesh>(mesh),
                           .pitch_mm = kPitchMm};
}

struct Stock {
  TrueSolid truth;
  CutSurface surface;
  explicit Stock(const TriangleMesh& mesh, const std::map<ToolId, SceneTool>& tools = {},
                 const std::vector<ProgramMotion>& motions = {})
      : truth(mesh_bounds(mesh), tools, motions, 4, &mesh),
        surface(sample_cut_surface(truth, kSamples)) {}
  std::vector<ThinWall> walls() const { return find_thin_walls(truth, surface, {kPitchMm, 0.001}); }
};

TEST(StockMesh, ContainsTheKernelsSolid) {
  const TriangleMesh mesh = with_fin();
  const StockMesh exact(mesh), reversed(inside_out(mesh));
  Sculpture sculpture = Sculpture::create(settings_of(mesh)).value();
  const DexelSnapshot field = sculpture.snapshot();
  std::mt19937 random(1);
  std::vector<Dexel> scratch;
  for (int n = 0; n < 2000; ++n) {
    const auto i = static_cast<std::int32_t>(random() % field.grid().columns_x);
    const auto j = static_cast<std::int32_t>(random() % field.grid().columns_y);
    const Vec3 p{field.grid().x_mm(i), field.grid().y_mm(j),
                 10.1 * double(random()) / 4294967296.0};
    const bool solid = std::ranges::any_of(field.column(i, j, scratch), [&](const Dexel& dexel) {
      return field.grid().z_mm(dexel.bottom) < p.z && p.z < field.grid().z_mm(dexel.top);
    });
    EXPECT_EQ(exact.contains(p), solid) << p.x << ' ' << p.y << ' ' << p.z;
    EXPECT_EQ(reversed.contains(p), solid);
  }
}

TEST(StockMesh, DistanceIsNegativeInside) {
  const TriangleMesh mesh = base();
  const StockMesh exact(mesh);
  EXPECT_NEAR(exact.nearest({5, 5, 4.5}, 9).mm, -0.5, 1e-6);
  EXPECT_NEAR(exact.nearest({5, 5, 4.5}, 9).outward.z, 1, 1e-6);
  EXPECT_NEAR(exact.nearest({5, 5, 7}, 9).mm, 2, 1e-6);
  EXPECT_NEAR(exact.nearest({5, 5, 7}, 9).outward.z, 1, 1e-6);
  EXPECT_EQ(exact.nearest({5, 5, 7}, 1).mm, 1);
  EXPECT_EQ(exact.nearest({5, 5, 3}, 1).mm, -1);
}

TEST(ThinStock, FinOfAMeshIsFoundAndMissing) {
  for (const TriangleMesh& mesh : {with_fin(), inside_out(with_fin())}) {
    const Stock stock(mesh);
    auto walls = stock.walls();
    ASSERT_FALSE(walls.empty());
    for (const ThinWall& wall : walls) {
      EXPECT_FALSE(wall.groove);
      EXPECT_NEAR(wall.thickness_mm, 0.14, 1e-4);
      EXPECT_NEAR(wall.mm.x, 9.9, 1e-4);
    }
    EXPECT_LE(distinct_walls(walls, {}, kPitchMm).size(), 10u);
    // Columns are at odd multiples of 0.15 mm.
    mark_missing(walls, Sculpture::create(settings_of(mesh)).value().snapshot());
    for (const ThinWall& wall : walls) EXPECT_TRUE(wall.missing);
  }
}

TEST(ThinStock, GapBetweenBodiesOfAMeshIsFoundAndMissing) {
  const TriangleMesh mesh = with_gap();
  auto walls = Stock(mesh).walls();
  ASSERT_FALSE(walls.empty());
  mark_missing(walls, Sculpture::create(settings_of(mesh)).value().snapshot());
  for (const ThinWall& wall : walls) {
    EXPECT_TRUE(wall.groove);
    EXPECT_TRUE(wall.missing);
    EXPECT_NEAR(wall.thickness_mm, 0.14, 1e-4);
  }
}

TEST(ThinStock, ThickMeshesAndHorizontalPlatesAreNotReported) {
  EXPECT_TRUE(Stock(base()).walls().empty());
  TriangleMesh blocks = base();  // two overlapping bodies
  add_box(blocks, {5, 5, 3}, {15, 15, 9});
  EXPECT_TRUE(Stock(blocks).walls().empty());
  TriangleMesh plate;
  add_box(plate, {0, 0, 0}, {20, 20, 0.14});
  EXPECT_TRUE(Stock(plate).walls().empty());
}

TEST(ThinStock, WallBetweenACutAndTheMeshIsFound) {
  const ToolShape shape = FlatShape{3, 30};
  const std::map<ToolId, SceneTool> tools{
      {1, {.shape = shape, .body = {}, .tool = make_tool(shape).value()}}};
  // The blocks end at x = 18, so a slot next to that leaves 0.14 mm.
  const Stock stock(with_gap(), tools, {{1, {{16.36, -5, 6}}, {{16.36, 25, 6}}, 1, 0, false}});
  const auto walls = stock.walls();
  EXPECT_TRUE(std::ranges::any_of(walls, [](const ThinWall& wall) {
    return !wall.groove && wall.sweep == 0 && wall.other_sweep == 1 &&
           std::abs(wall.thickness_mm - 0.14) < 1e-4 && std::abs(wall.mm.x - 17.93) < 1e-3;
  }));
}

TEST(ThinStock, RemovedFinIsNotReported) {
  const ToolShape shape = FlatShape{6, 30};
  const std::map<ToolId, SceneTool> tools{
      {1, {.shape = shape, .body = {}, .tool = make_tool(shape).value()}}};
  const Stock stock(with_fin(), tools, {{1, {{10, -5, 5}}, {{10, 25, 5}}, 1, 0, false}});
  EXPECT_TRUE(stock.walls().empty());
}

TEST(ThinStock, FinDeterminesThePitchForATarget) {
  const auto pitch_of = [](const TriangleMesh& mesh) {
    const Stock stock(mesh);
    return pitch_for_walls(stock.truth, stock.surface, {kPitchMm, 1.2 * kPitchMm, 0.001});
  };
  for (const TriangleMesh& mesh : {with_fin(), with_gap()}) {
    const auto pitch = test::value_of(pitch_of(mesh));
    EXPECT_LE(pitch, 0.14 * 1.02);
    EXPECT_GT(pitch, 0.14 / 1.2);
  }
  EXPECT_EQ(pitch_of(base()), kPitchMm);
}

}  // namespace
}  // namespace kerf::thin_stock_test
