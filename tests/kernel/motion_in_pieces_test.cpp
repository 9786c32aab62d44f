// SPDX-License-Identifier: Apache-2.0
#include "kernel/motion_in_pieces.h"

#include "kernel/dexel/dexel_field.h"
#include "kernel/sculpture.h"
#include "tests/support/test.h"

namespace kerf::motion_in_pieces_test {
namespace {

/// Random moves of four tools, in and around a block of 24 x 24 x 8 mm.
class Moves {
 public:
  explicit Moves(unsigned seed) : random_(seed) {}

  MoveTool next() {
    const Vec3 from{uniform(-2, 26), uniform(-2, 26), uniform(-4, 6)};
    const Vec3 to = from + Vec3{uniform(-20, 20), uniform(-20, 20), uniform(-3, 3)};
    const Vec3 axis = normalized({uniform(-0.5, 0.5), uniform(-0.5, 0.5), 1});
    Vec3 turned = axis;
    if (random_() % 2 == 0) turned = normalized(axis + Vec3{uniform(-0.3, 0.3), 0, 0});
    const auto tool = static_cast<ToolId>(1 + random_() % 4);
    const MoveTool move{tool, {from, axis}, {to, turned}, 1, false};
    // Half of the moves continue the one before with the same tool.
    const bool continues = last_ && random_() % 2 == 0;
    last_ = continues ? MoveTool{last_->tool, last_->to, move.to, 1, false} : move;
    return *last_;
  }
  std::int64_t tiles() { return 1 + static_cast<std::int64_t>(random_() % 7); }

 private:
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 4294967296.0);
  }
  std::mt19937 random_;
  std::optional<MoveTool> last_;
};

Sculpture block(Rays rays, bool keep_normals) {
  Sculpture sculpture = *Sculpture::create({.stock = BoxStock{{0, 0, -8}, {24, 24, 0}},
                                            .rays = rays,
                                            .pitch_mm = 0.1,
                                            .keep_normals = keep_normals});
  const auto define = [&](ToolId id, const ToolShape& shape) {
    sculpture.apply(DefineTool{id, make_tool(shape).value()}).value();
  };
  define(1, BallShape{.diameter_mm = 8, .length_mm = 30});
  define(2, FlatShape{.diameter_mm = 9, .length_mm = 30});
  define(3, TaperShape{.diameter_mm = 3, .half_angle_deg = 15, .length_mm = 20});
  define(4, ConeEndShape{.diameter_mm = 6, .tip_angle_deg = 90, .length_mm = 30});
  return sculpture;
}

MotionResult complete(Sculpture& sculpture, MotionInPieces motion, Moves& moves) {
  for (;;) {
    if (auto result = sculpture.advance(motion, moves.tiles())) return *std::move(result);
  }
}

std::vector<FieldTile> sorted(std::vector<FieldTile> tiles) {
  std::ranges::sort(tiles);
  const auto repeated = std::ranges::unique(tiles);
  tiles.erase(repeated.begin(), repeated.end());
  return tiles;
}

TEST(MotionInPieces, EqualsTheWholeMotionToTheBit) {
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    Sculpture whole = block(rays, false), pieces = block(rays, false);
    Moves moves(7), sizes(8);
    for (int n = 0; n < 30; ++n) {
      const MoveTool move = moves.next();
      const MotionResult expected = whole.apply(move).value();
      const MotionResult result = complete(pieces, pieces.begin(move).value(), sizes);
      ASSERT_EQ(pieces.state_hash(), whole.state_hash()) << n;
      EXPECT_EQ(result.removed_mm3, expected.removed_mm3) << n;
      EXPECT_EQ(result.imprint_mm3, expected.imprint_mm3) << n;
      EXPECT_EQ(result.sub_motions, expected.sub_motions) << n;
      EXPECT_EQ(result.kind, expected.kind) << n;
      EXPECT_EQ(result.changed_tiles, expected.changed_tiles) << n;
      EXPECT_EQ(sorted(result.cut_tiles), sorted(expected.cut_tiles)) << n;
    }
    EXPECT_GT(whole.removed_volume_mm3(), 100);
    EXPECT_EQ(pieces.removed_volume_mm3(), whole.removed_volume_mm3());
    EXPECT_EQ(pieces.imprint_volume_mm3(), whole.imprint_volume_mm3());
    EXPECT_EQ(pieces.motions(), whole.motions());
  }
}

TEST(MotionInPieces, OtherMotionsInBetweenDoNotChangeTheSolid) {
  for (const bool keep_normals : {false, true}) {
    Sculpture whole = block(Rays::kDexel, keep_normals), pieces = block(Rays::kDexel, keep_normals);
    Moves moves(3), sizes(4);
    for (int n = 0; n < 20; ++n) {
      const MoveTool move = moves.next();
      whole.apply(move).value();
      MotionInPieces motion = pieces.begin(move).value();
      while (!pieces.advance(motion, sizes.tiles())) {
        const MoveTool other = moves.next();
        whole.apply(other).value();
        pieces.apply(other).value();
        (void)pieces.solid();  // as for a viewer
      }
      ASSERT_EQ(pieces.state_hash(), whole.state_hash()) << n;
    }
  }
}

TEST(MotionInPieces, PiecesCutNoMoreTilesThanAllowed) {
  Sculpture sculpture = block(Rays::kDexel, false);
  const MoveTool across{2, {{-10, 12, -2}, {0, 0, 1}}, {{34, 12, -2}, {0, 0, 1}}, 1, false};
  EXPECT_GE(sculpture.tiles_in_reach(across), 16);
  MotionInPieces motion = sculpture.begin(across).value();
  int pieces = 1;
  while (!sculpture.advance(motion, 1)) ++pieces;
  EXPECT_GE(pieces, 16);
  EXPECT_LE(pieces, sculpture.tiles_in_reach(across) + 1);
}

/// Topmost elements along Z with a normal that is pending: codes of normals are at least 2^16.
int pending_ends(const Sculpture& sculpture) {
  const DexelField& field = *sculpture.field(RayAxis::kZ);
  const auto is_pending = [](NormalCode code) { return code != kStockNormal && code < 0x10000; };
  int pending = 0;
  for (std::int32_t y = 0; y < field.grid().tiles_y(); ++y) {
    for (std::int32_t x = 0; x < field.grid().tiles_x(); ++x) {
      const DexelTile* tile = field.find({x, y});
      if (tile == nullptr) continue;
      pending += static_cast<int>(std::ranges::count_if(tile->topmost_codes, [&](EndCodes codes) {
        return is_pending(codes.top) || is_pending(codes.bottom);
      }));
    }
  }
  return pending;
}

TEST(MotionInPieces, NoNormalsArePendingBetweenPieces) {
  Sculpture sculpture = block(Rays::kDexel, true);
  const MoveTool across{2, {{-10, 12, -2}, {0, 0, 1}}, {{34, 12, -2}, {0, 0, 1}}, 1, false};
  MotionInPieces motion = sculpture.begin(across).value();
  int pieces = 0;
  for (; !sculpture.advance(motion, 2); ++pieces) EXPECT_EQ(pending_ends(sculpture), 0) << pieces;
  EXPECT_GE(pieces, 8);
  EXPECT_GT(pending_ends(sculpture), 0) << "those of the last piece";
}

TEST(MotionInPieces, ReachCountsTheTilesThatAMotionMayChange) {
  Sculpture sculpture = block(Rays::kTriDexel, false);
  Moves moves(5);
  for (int n = 0; n < 100; ++n) {
    const MoveTool move = moves.next();
    const std::int64_t reach = sculpture.tiles_in_reach(move);
    const auto changed = sorted(sculpture.apply(move).value().cut_tiles);
    EXPECT_LE(static_cast<std::int64_t>(changed.size()), reach) << n;
  }
  const MoveTool away{1, {{100, 100, 0}, {0, 0, 1}}, {{110, 100, 0}, {0, 0, 1}}, 1, false};
  EXPECT_EQ(sculpture.tiles_in_reach(away), 0);
}

TEST(MotionInPieces, InvalidMotionIsRejectedBeforeItBegins) {
  Sculpture sculpture = block(Rays::kDexel, false);
  const MoveTool unknown{9, {{0, 0, 0}, {0, 0, 1}}, {{1, 0, 0}, {0, 0, 1}}, 1, false};
  EXPECT_FALSE(sculpture.begin(unknown));
}

}  // namespace
}  // namespace kerf::motion_in_pieces_test
