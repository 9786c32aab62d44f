// SPDX-License-Identifier: Apache-2.0
#include "kernel/tile_carver.h"

#include "kernel/dexel/common_solid.h"
#include "kernel/dexel/dexel_field.h"
#include "kernel/dexel/dexel_tile.h"
#include "kernel/sculpture.h"
#include "kernel/sculpture_motion.h"
#include "tests/support/test.h"

namespace kerf::tile_carver_test {
namespace {

/// Blocks of 24 x 20 x 8 mm, motions of four tools in and around them, and every tile.
class History {
 public:
  History(const SculptureSettings& settings, unsigned seed) : settings_(settings), random_(seed) {
    tools_.push_back(*make_tool(BallShape{.diameter_mm = 6, .length_mm = 30}));
    tools_.push_back(*make_tool(FlatShape{.diameter_mm = 5, .length_mm = 30}));
    tools_.push_back(*make_tool(BullNoseShape{7, 2, 30}));
    tools_.push_back(
        *make_tool(TaperShape{.diameter_mm = 2, .half_angle_deg = 15, .length_mm = 20}));
    for (int n = 0; n < 24; ++n) motions_.push_back(next());
  }

  const std::vector<MoveTool>& motions() const { return motions_; }
  const Tool& tool(const MoveTool& motion) const { return tools_[motion.tool - 1]; }
  /// Returns a block with these motions, of which some continue the previous one.
  Sculpture block(const std::vector<MoveTool>& motions) const {
    Sculpture sculpture = Sculpture::create(settings_).value();
    for (ToolId id = 1; id <= tools_.size(); ++id) {
      sculpture.apply(DefineTool{id, tools_[id - 1]}).value();
    }
    for (const MoveTool& motion : motions) sculpture.apply(motion).value();
    return sculpture;
  }
  /// Returns a subset in random order.
  std::vector<MoveTool> some() {
    std::vector<MoveTool> chosen;
    for (const MoveTool& motion : motions_) {
      if (random_() % 3 != 0) chosen.push_back(motion);
    }
    std::ranges::shuffle(chosen, random_);
    return chosen;
  }
  std::vector<FieldTile> tiles() const {
    const Sculpture sculpture = Sculpture::create(settings_).value();
    std::vector<FieldTile> all;
    for (const RayAxis axis : {RayAxis::kX, RayAxis::kY, RayAxis::kZ}) {
      const DexelField* field = sculpture.field(axis);
      if (field == nullptr) continue;
      for (std::int32_t y = 0; y < field->grid().tiles_y(); ++y) {
        for (std::int32_t x = 0; x < field->grid().tiles_x(); ++x) all.push_back({axis, {x, y}});
      }
    }
    std::ranges::sort(all);
    return all;
  }
  TileCarver carver() const {
    return TileCarver(settings_, Sculpture::create(settings_).value().solid());
  }

 private:
  MoveTool next() {
    const Vec3 from{uniform(-2, 26), uniform(-2, 22), uniform(-6, 4)};
    const Vec3 to = from + Vec3{uniform(-14, 14), uniform(-14, 14), uniform(-3, 3)};
    const Vec3 axis = normalized({uniform(-0.5, 0.5), uniform(-0.5, 0.5), 1});
    Vec3 turned = axis;
    if (random_() % 2 == 0) turned = normalized(axis + Vec3{uniform(-0.3, 0.3), 0, 0});
    const auto tool = static_cast<ToolId>(1 + random_() % tools_.size());
    MoveTool move{tool, {from, axis}, {to, turned}, 1, false};
    const bool continues = !motions_.empty() && random_() % 2 == 0;
    if (continues) move.tool = motions_.back().tool, move.from = motions_.back().to;
    if (!continues || dot(move.from.axis, move.to.axis) > 0.2) return move;
    return {tool, {from, axis}, {to, turned}, 1, false};
  }
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 4294967296.0);
  }

  SculptureSettings settings_;
  std::mt19937 random_;
  std::vector<Tool> tools_;
  std::vector<MoveTool> motions_;
};

SculptureSettings settings_of(Rays rays, const StockShape& stock, bool keep_normals = true) {
  return SculptureSettings{
      .stock = stock, .rays = rays, .pitch_mm = 0.3, .keep_normals = keep_normals};
}

std::vector<SculptureSettings> every_kind() {
  const BoxStock box{{0, 0, -8}, {24, 20, 0}};
  const CylinderStock cylinder{12, 10, 9, -8, 0};
  SculptureSettings mesh = settings_of(Rays::kTriDexel, box);
  const Vec3 corners[] = {{0, 0, -8}, {24, 0, -8}, {3, 20, -8}, {8, 8, 0}};
  auto tetrahedron = std::make_shared<TriangleMesh>();
  tetrahedron->vertices_mm.assign(std::begin(corners), std::end(corners));
  tetrahedron->triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  mesh.stock_mesh = tetrahedron;
  return {settings_of(Rays::kDexel, box), settings_of(Rays::kTriDexel, box),
          settings_of(Rays::kTriDexel, cylinder), settings_of(Rays::kDexel, cylinder, false), mesh};
}

std::vector<TileReplacement> carved(History& history, TileCarver& carver,
                                    const std::vector<MoveTool>& motions) {
  const std::vector<FieldTile> tiles = history.tiles();
  for (const MoveTool& move : motions) {
    const Tool& tool = history.tool(move);
    carver.cut(tool, motion_of(move, tool), tiles);
  }
  std::vector<TileReplacement> all;
  for (const FieldTile at : tiles) {
    auto tile = carver.take(at);
    all.push_back({at, tile ? tile : carver.start(at)});
  }
  return all;
}

TEST(TileCarver, ReplacedTilesEqualABlockWithoutTheUndoneMotions) {
  unsigned seed = 1;
  int different = 0;
  for (const SculptureSettings& settings : every_kind()) {
    for (int round = 0; round < 2; ++round) {
      History history(settings, seed++);
      Sculpture block = history.block(history.motions());
      const std::vector<MoveTool> rest = history.some();
      Sculpture never = history.block(rest);
      TileCarver carver = history.carver();
      const double before_mm3 = block.removed_volume_mm3();
      const bool differs = block.state_hash() != never.state_hash();
      const ReplacedTiles replaced = block.replace(carved(history, carver, rest));
      EXPECT_EQ(block.state_hash(), never.state_hash()) << "seed " << seed - 1;
      // Some motions miss the block, or cut the same material as the remaining ones.
      EXPECT_EQ(replaced.returned_mm3 > 0, differs) << "seed " << seed - 1;
      EXPECT_EQ(replaced.changed_tiles.empty(), !differs);
      different += differs ? 1 : 0;
      EXPECT_NEAR(before_mm3 - block.removed_volume_mm3(), replaced.returned_mm3, 1e-9);
      // The carver begins each tile again.
      block.replace(carved(history, carver, history.motions()));
      EXPECT_EQ(block.state_hash(), history.block(history.motions()).state_hash());
      EXPECT_TRUE(block.replace(carved(history, carver, history.motions())).tiles.empty());
    }
  }
  EXPECT_GE(different, 7);
}

/// A Sculpture knows that the start of a motion has been cut, and leaves it out; a carver of tiles
/// does not. With a fine pitch a difference of one quantum would affect some ray.
TEST(TileCarver, UnknownStartsGiveTheSameBytes) {
  const Vec3 up{0, 0, 1};
  SculptureSettings settings{
      .stock = BoxStock{{-2.5, -2.5, -6}, {2.5, 2.5, 0}}, .pitch_mm = 0.05, .tolerance_mm = 0.002};
  for (const ToolShape& shape :
       {ToolShape(BullNoseShape{4, 0.05, 30}), ToolShape(BullNoseShape{4, 1, 30}),
        ToolShape(FlatShape{4, 30}), ToolShape(BallShape{4, 30})}) {
    const Tool tool = *make_tool(shape);
    for (unsigned seed = 0; seed < 60; ++seed) {
      std::mt19937_64 random(seed);
      const test::Uniform in(random);
      Sculpture block = Sculpture::create(settings).value();
      block.apply(DefineTool{1, tool}).value();
      TileCarver carver(settings, block.solid());
      const DexelField& field = *block.field(RayAxis::kZ);
      std::vector<FieldTile> tiles;
      for (std::int32_t y = 0; y < field.grid().tiles_y(); ++y) {
        for (std::int32_t x = 0; x < field.grid().tiles_x(); ++x)
          tiles.push_back({RayAxis::kZ, {x, y}});
      }
      Vec3 at{in(-2.5, 2.5), in(-2.5, 2.5), in(-5, -3)};
      Vec3 next = at - Vec3{0, 0, 1};
      for (int n = 0; n < 3; ++n) {
        const MoveTool move{1, {at, up}, {next, up}, 0};
        block.apply(move).value();
        carver.cut(tool, motion_of(move, tool), tiles);
        at = next;
        next = {in(-2.5, 2.5), in(-2.5, 2.5), at.z};
      }
      for (const FieldTile& tile : tiles) {
        const DexelTile *one = field.find(tile.tile), *other = carver.find(tile);
        if (other == nullptr) continue;  // no motion has reached it
        ASSERT_NE(one, nullptr);
        std::vector<Dexel> expected, found;
        for (int column = 0; column < kTileColumns; ++column) {
          one->read(column, expected);
          other->read(column, found);
          ASSERT_EQ(found, expected) << "shape " << shape.index() << ", seed " << seed;
        }
      }
    }
  }
}

TEST(TileCarver, CarvingContinuesAfterReplacement) {
  for (const SculptureSettings& settings : every_kind()) {
    History history(settings, 77);
    std::vector<MoveTool> rest = history.some();
    Sculpture block = history.block(history.motions());
    TileCarver carver = history.carver();
    block.replace(carved(history, carver, rest));
    const std::vector<MoveTool> later = history.some();
    for (const MoveTool& motion : later) block.apply(motion).value();
    rest.insert(rest.end(), later.begin(), later.end());
    EXPECT_EQ(block.state_hash(), history.block(rest).state_hash());
  }
}

TEST(TileCarver, MotionsSinceAreCutFromTheReplacedTiles) {
  for (const SculptureSettings& settings : every_kind()) {
    History history(settings, 12);
    Sculpture block = history.block(history.motions());
    std::vector<MoveTool> rest = history.some();
    const std::vector<MoveTool> later = history.some();
    std::vector<MotionSince> since;
    for (const MoveTool& motion : later) since.push_back({&history.tool(motion), motion});
    for (const MoveTool& motion : later) block.apply(motion).value();
    TileCarver carver = history.carver();
    const double before_mm3 = block.removed_volume_mm3();
    const ReplacedTiles replaced = block.replace(carved(history, carver, rest), since);
    rest.insert(rest.end(), later.begin(), later.end());
    EXPECT_EQ(block.state_hash(), history.block(rest).state_hash());
    EXPECT_NEAR(before_mm3 - block.removed_volume_mm3(), replaced.returned_mm3, 1e-9);
    EXPECT_TRUE(block.replace(carved(history, carver, rest)).tiles.empty());
  }
}

TEST(TileCarver, ToolIsInStockOnlyWhereItWouldCut) {
  for (const SculptureSettings& settings : every_kind()) {
    History history(settings, 3);
    Sculpture block = Sculpture::create(settings).value();
    const Vec3 up{0, 0, 1};
    EXPECT_FALSE(block.is_in_stock(1, {{8, 8, -2}, up}));  // an unknown tool
    block = history.block({});
    EXPECT_FALSE(block.is_in_stock(1, {{8, 8, 0.5}, up}));
    EXPECT_TRUE(block.is_in_stock(1, {{8, 8, -2}, up}));
    const std::uint64_t before = block.state_hash();
    for (const MoveTool& motion : history.motions()) {
      block.apply(motion).value();
      EXPECT_FALSE(block.is_in_stock(motion.tool, motion.to));
    }
    EXPECT_NE(block.state_hash(), before);
  }
}

TEST(TileCarver, DistantToolKeepsItsForce) {
  const SculptureSettings settings = settings_of(Rays::kDexel, BoxStock{{0, 0, -8}, {60, 20, 0}});
  History history(settings, 1);
  const Vec3 up{0, 0, 1};
  const auto slot = [&](double from_x) {
    return MoveTool{1, {{from_x, 10, -4}, up}, {{from_x + 0.5, 10, -4}, up}, 0.02, true};
  };
  double forces_n[2] = {};
  for (const bool replaces : {false, true}) {
    Sculpture block = history.block({});
    block.apply(MoveTool{2, {{55, 4, -2}, up}, {{55, 16, -2}, up}, 0.1, false}).value();
    for (double x = -4; x < 12; x += 0.5) block.apply(slot(x)).value();
    const FieldTile far{RayAxis::kZ, {5, 0}};
    const TileReplacement untouched{far, nullptr};
    if (replaces) {
      EXPECT_GT(block.replace({&untouched, 1}).returned_mm3, 1);
    }
    forces_n[replaces ? 1 : 0] = length(block.apply(slot(12)).value().wrench.force_n);
  }
  EXPECT_EQ(forces_n[0], forces_n[1]);
}

TEST(TileCarver, CommonSolidEqualsCarvingByBothSets) {
  for (const SculptureSettings& settings : every_kind()) {
    History history(settings, 5);
    const auto& all = history.motions();
    const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
    TileCarver carver = history.carver();
    const auto first = carved(history, carver, {all.begin(), middle});
    const auto second = carved(history, carver, {middle, all.end()});
    std::vector<TileReplacement> both;
    for (std::size_t n = 0; n < first.size(); ++n) {
      if (!first[n].tile || !second[n].tile) {
        both.push_back(first[n].tile ? first[n] : second[n]);
        continue;
      }
      auto common = std::make_shared<DexelTile>(*first[n].tile);
      keep_common(*common, *second[n].tile);
      both.push_back({first[n].at, common});
    }
    Sculpture block = Sculpture::create(settings).value();
    block.replace(both);
    EXPECT_EQ(block.state_hash(), history.block(all).state_hash());
  }
}

/// Returns the share of ends whose normals differ between two blocks of equal solid.
double differing_normals(Sculpture& a, Sculpture& b) {
  long ends = 0, differ = 0;
  const SolidSnapshot left = a.solid(), right = b.solid();
  for (std::size_t n = 0; n < left.fields.size(); ++n) {
    const DexelGrid& grid = left.fields[n].grid();
    for (std::int32_t j = 0; j < grid.columns_y; ++j) {
      for (std::int32_t i = 0; i < grid.columns_x; ++i) {
        const ColumnView u = left.fields[n].view(i, j), v = right.fields[n].view(i, j);
        if (u.topmost.bottom >= u.topmost.top) continue;
        for (std::size_t k = 0; k < u.lower_codes.size(); ++k) {
          ++ends;
          differ += u.lower_codes[k] == v.lower_codes[k] ? 0 : 1;
        }
        ++ends;
        differ += u.topmost_codes == v.topmost_codes ? 0 : 1;
      }
    }
  }
  return static_cast<double>(differ) / static_cast<double>(ends);
}

TEST(TileCarver, EndsHaveTheNormalsOfTheMotionsThatMadeThem) {
  // If two motions leave an end at one depth, the order decides, so few may differ.
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    const SculptureSettings settings = settings_of(rays, BoxStock{{0, 0, -8}, {24, 20, 0}});
    History history(settings, 9);
    const std::vector<MoveTool> rest = history.some();
    Sculpture never = history.block(rest);
    TileCarver carver = history.carver();
    Sculpture block = history.block(history.motions());
    block.replace(carved(history, carver, rest));
    EXPECT_LT(differing_normals(block, never), 0.01);
    // The same for the two halves.
    const auto middle = rest.begin() + static_cast<std::ptrdiff_t>(rest.size() / 2);
    auto halves = carved(history, carver, {rest.begin(), middle});
    const auto others = carved(history, carver, {middle, rest.end()});
    for (std::size_t n = 0; n < halves.size(); ++n) {
      if (!halves[n].tile || !others[n].tile) {
        if (!halves[n].tile) halves[n] = others[n];
        continue;
      }
      auto common = std::make_shared<DexelTile>(*halves[n].tile);
      keep_common(*common, *others[n].tile);
      halves[n].tile = common;
    }
    Sculpture merged = Sculpture::create(settings).value();
    merged.replace(halves);
    EXPECT_LT(differing_normals(merged, never), 0.01);
  }
}

TEST(TileCarver, StockRestoredAroundAToolIsImprint) {
  const SculptureSettings settings = settings_of(Rays::kDexel, BoxStock{{0, 0, -8}, {24, 20, 0}});
  History history(settings, 1);
  Sculpture block = history.block({});
  const Vec3 up{0, 0, 1};
  const auto slot = [&](double from_x, double to_x) {
    return MoveTool{1, {{from_x, 10, -4}, up}, {{to_x, 10, -4}, up}, 0.02, true};
  };
  double steady_n = 0;
  for (double x = -4; x < 12; x += 0.5) {
    steady_n = length(block.apply(slot(x, x + 0.5)).value().wrench.force_n);
  }
  TileCarver carver = history.carver();
  block.replace(carved(history, carver, {}));
  EXPECT_NEAR(block.removed_volume_mm3(), 0, 1e-9);
  const MotionResult next = block.apply(slot(12, 12.5)).value();
  EXPECT_GT(next.imprint_mm3, 50);
  EXPECT_LT(length(next.wrench.force_n), 1.5 * steady_n);
}

}  // namespace
}  // namespace kerf::tile_carver_test
