// SPDX-License-Identifier: Apache-2.0
// Invariants of any motions in any order: seeded random motions, every tool, one field and three.

#include "tests/kernel/extremes/carving.h"
#include "tests/support/test.h"

namespace kerf::test::invariant_test {
namespace {

using Random = std::mt19937_64;

double in(Random& random, double a, double b) {
  return std::uniform_real_distribution<double>(a, b)(random);
}

struct Move {
  ToolPose from, to;
};

enum class Turning { kNone, kSome };

/// Random moves in a block of 24 x 24 x 12 mm whose top is at z = 0: short and long, level and
/// steep; a third of them turn, a few by large angles.
std::vector<Move> random_moves(unsigned seed, int count, Turning turning = Turning::kSome) {
  Random random(seed);
  std::vector<Move> moves;
  for (int i = 0; i < count; ++i) {
    const ToolPose from = leaning({in(random, -11, 11), in(random, -11, 11), in(random, -6, 1)},
                                  in(random, 0, 0.8), in(random, 0, 6.2));
    const double reach = i % 4 == 0 ? 12 : 2;
    const Vec3 travel{in(random, -reach, reach), in(random, -reach, reach), in(random, -2, 2)};
    const bool turns = turning == Turning::kSome && i % 3 == 0;
    const double turn = turns ? (i % 2 == 0 ? in(random, 0, 0.1) : in(random, 0, 1.2)) : 0;
    const Vec3 about{in(random, -1, 1), in(random, -1, 1), in(random, -1, 1)};
    moves.push_back(
        {from, {from.tip_mm + travel, turns ? turned(from.axis, about, turn) : from.axis}});
  }
  return moves;
}

SculptureSettings small_block(Rays rays, double tolerance_mm = 0.01) {
  SculptureSettings s = block(24, 12, 0.75, tolerance_mm);
  s.rays = rays;
  return s;
}

Sculpture carved(const SculptureSettings& settings, const Tool& tool,
                 const std::vector<Move>& moves) {
  Sculpture s = Sculpture::create(settings).value();
  s.apply(DefineTool{1, tool}).value();
  for (const Move& m : moves) s.apply(MoveTool{1, m.from, m.to, 0.01}).value();
  return s;
}

constexpr Rays kBoth[] = {Rays::kDexel, Rays::kTriDexel};

TEST(Invariant, ElementsStayValidAndTheVolumeNeverGrows) {
  for (const NamedTool& t : every_tool(0.6)) {
    for (const Rays rays : kBoth) {
      Sculpture s = carved(small_block(rays), t.tool, {});
      double volume = s.snapshot().volume_mm3();
      for (const Move& m : random_moves(7, 24)) {
        const MotionResult r = s.apply(MoveTool{1, m.from, m.to, 0.01}).value();
        EXPECT_GE(r.removed_mm3, 0) << t.name;
        const double now = s.snapshot().volume_mm3();
        EXPECT_LE(now, volume) << t.name;
        if (rays == Rays::kDexel) {
          EXPECT_NEAR(r.removed_mm3, volume - now, 1e-9 * volume);
        }
        EXPECT_EQ(r.changed_tiles.empty(), now == volume) << t.name;
        EXPECT_TRUE(std::ranges::is_sorted(r.changed_tiles)) << t.name;
        volume = now;
      }
      for (const RayAxis axis : {RayAxis::kX, RayAxis::kY, RayAxis::kZ}) {
        if (s.has_field(axis)) expect_sound(s.snapshot(axis), t.name);
      }
    }
  }
}

TEST(Invariant, RemovedPointsAreInTheSweepsAndRemainingPointsOutside) {
  for (const NamedTool& t : every_tool(0.6)) {
    for (const Rays rays : kBoth) {
      for (unsigned seed = 3; seed < 3 + 2 * unsigned(effort()); ++seed) {
        Carving carving(small_block(rays), t.tool);
        for (const Move& m : random_moves(seed, 7)) carving.move(m.from, m.to);
        carving.expect_within_tolerance(t.name + " " + to_string(rays), 8, seed);
      }
    }
  }
}

TEST(Invariant, RoundStockIsCarvedLikeTheBoxAroundIt) {
  const std::vector<Move> moves = random_moves(21, 12);
  for (const NamedTool& t : every_tool(0.6)) {
    SculptureSettings round = small_block(Rays::kDexel);
    round.stock = CylinderStock{0, 0, 12, -12, 0};
    Sculpture whole = carved(small_block(Rays::kDexel), t.tool, moves);
    Sculpture part = carved(round, t.tool, moves);
    const DexelSnapshot a = whole.snapshot(), b = part.snapshot();
    const DexelGrid& g = b.grid();
    for (std::int32_t j = 0; j < g.columns_y; ++j) {
      for (std::int32_t i = 0; i < g.columns_x; ++i) {
        const bool inside = g.x_mm(i) * g.x_mm(i) + g.y_mm(j) * g.y_mm(j) <= 144;
        EXPECT_EQ(column_of(b, i, j), inside ? column_of(a, i, j) : std::vector<Dexel>{}) << t.name;
      }
    }
  }
}

TEST(Invariant, AnyOrderOfTheSameMotionsGivesTheSameBytes) {
  for (const NamedTool& t : every_tool(0.6)) {
    for (const Rays rays : kBoth) {
      std::vector<Move> moves = random_moves(11, 14);
      const std::uint64_t state = carved(small_block(rays), t.tool, moves).state_hash();
      Random random(5);
      for (int k = 0; k < 3; ++k) {
        std::ranges::shuffle(moves, random);
        EXPECT_EQ(carved(small_block(rays), t.tool, moves).state_hash(), state) << t.name;
      }
    }
  }
}

TEST(Invariant, AnyOrderOfTheMovesOfAPathGivesTheSameBytes) {
  // Each move starts where a previous one ended. A kernel may skip the stock that is already cut
  // there, but only if the move that cut it came before.
  for (const NamedTool& t : every_tool(0.6)) {
    for (const Rays rays : kBoth) {
      std::vector<Move> moves = random_moves(13, 14);
      for (std::size_t k = 1; k < moves.size(); ++k) moves[k].from = moves[k - 1].to;
      const std::uint64_t state = carved(small_block(rays), t.tool, moves).state_hash();
      Random random(5);
      for (int k = 0; k < 3; ++k) {
        std::ranges::shuffle(moves, random);
        EXPECT_EQ(carved(small_block(rays), t.tool, moves).state_hash(), state) << t.name;
      }
    }
  }
}

TEST(Invariant, RedefinedToolCutsAtItsPose) {
  // The new tool starts where the old one ended, but its own shape has not been cut there yet.
  const std::vector<NamedTool> tools = every_tool(0.6);
  for (const NamedTool& t : tools) {
    Sculpture s = Sculpture::create(small_block(Rays::kDexel)).value();
    const ToolPose a = leaning({-4, 0.1, -2}, 0.2), b{{4, 0.4, -2}, a.axis};
    s.apply(DefineTool{1, make_tool(BallShape{1, 20}).value()}).value();
    s.apply(MoveTool{1, a, b, 0.01}).value();
    s.apply(DefineTool{1, t.tool}).value();
    s.apply(MoveTool{1, b, a, 0.01}).value();
    Sculpture alone = carved(small_block(Rays::kDexel), t.tool, {{b, a}});
    alone.apply(DefineTool{2, make_tool(BallShape{1, 20}).value()}).value();
    alone.apply(MoveTool{2, a, b, 0.01}).value();
    EXPECT_EQ(s.state_hash(), alone.state_hash()) << t.name;
  }
}

/// Differences between two carvings of one grid: cut columns with different numbers of elements,
/// and the ends that differ and by how much.
struct Difference {
  int cut = 0, columns = 0, ends = 0;
  std::int32_t most = 0;  ///< quanta
};

template <class Other>
Difference difference(const DexelSnapshot& a, const DexelSnapshot& b, Other other) {
  Difference d;
  const DexelGrid& g = a.grid();
  for (std::int32_t j = 0; j < g.columns_y; ++j) {
    for (std::int32_t i = 0; i < g.columns_x; ++i) {
      const auto [k, l] = other(i, j);
      const std::vector<Dexel> p = column_of(a, i, j), q = column_of(b, k, l);
      if (p != std::vector<Dexel>{{0, g.height_quanta}}) ++d.cut;
      if (p.size() != q.size()) {
        ++d.columns;
        continue;
      }
      for (std::size_t e = 0; e < p.size(); ++e) {
        const std::int32_t far =
            std::max(std::abs(p[e].bottom - q[e].bottom), std::abs(p[e].top - q[e].top));
        if (far > 0) ++d.ends;
        d.most = std::max(d.most, far);
      }
    }
  }
  return d;
}

/// Two computations of the same end of a translation may round to adjacent quanta; where an arc is
/// hit by iteration, to one or two more. Nothing may differ by more.
constexpr std::int32_t kRoundingQuanta = 4;

void expect_equal_to_rounding(const Difference& d, const std::string& what,
                              std::int32_t allowed = kRoundingQuanta) {
  EXPECT_GT(d.cut, 100) << what << ": nothing was carved";
  EXPECT_EQ(d.columns, 0) << what;
  EXPECT_LE(d.most, allowed) << what << " (quanta)";
}

struct Place {
  std::int32_t i, j;
};

TEST(Invariant, SplittingATranslationChangesNothingButRounding) {
  const double shares[] = {0, 0.03, 0.2, 0.21, 0.5, 0.77, 1};
  for (const NamedTool& t : every_tool(0.6)) {
    const std::vector<Move> moves = random_moves(31, 20, Turning::kNone);
    std::vector<Move> parts;
    for (const Move& m : moves) {
      const auto at = [&](double share) {
        return ToolPose{m.from.tip_mm + (m.to.tip_mm - m.from.tip_mm) * share, m.from.axis};
      };
      for (std::size_t k = 1; k < std::size(shares); ++k) {
        parts.push_back({at(shares[k - 1]), at(shares[k])});
      }
      parts.back().to = m.to;
    }
    Sculpture whole = carved(small_block(Rays::kDexel), t.tool, moves);
    Sculpture split = carved(small_block(Rays::kDexel), t.tool, parts);
    expect_equal_to_rounding(difference(whole.snapshot(), split.snapshot(),
                                        [](std::int32_t i, std::int32_t j) { return Place{i, j}; }),
                             t.name);
  }
}

TEST(Invariant, ReversingATranslationChangesNothingButRounding) {
  for (const NamedTool& t : every_tool(0.6)) {
    std::vector<Move> moves = random_moves(33, 20, Turning::kNone);
    Sculpture there = carved(small_block(Rays::kDexel), t.tool, moves);
    for (Move& m : moves) std::swap(m.from, m.to);
    Sculpture back = carved(small_block(Rays::kDexel), t.tool, moves);
    expect_equal_to_rounding(difference(there.snapshot(), back.snapshot(),
                                        [](std::int32_t i, std::int32_t j) { return Place{i, j}; }),
                             t.name);
  }
}

struct Symmetry {
  const char* name;
  Vec3 (*of)(Vec3);
  Place (*place)(std::int32_t i, std::int32_t j, std::int32_t columns);
};

constexpr Symmetry kSymmetries[] = {
    {"mirrored in x", [](Vec3 v) { return Vec3{-v.x, v.y, v.z}; },
     [](std::int32_t i, std::int32_t j, std::int32_t n) { return Place{n - 1 - i, j}; }},
    {"mirrored in y", [](Vec3 v) { return Vec3{v.x, -v.y, v.z}; },
     [](std::int32_t i, std::int32_t j, std::int32_t n) { return Place{i, n - 1 - j}; }},
    {"x and y swapped", [](Vec3 v) { return Vec3{v.y, v.x, v.z}; },
     [](std::int32_t i, std::int32_t j, std::int32_t) { return Place{j, i}; }},
    {"a quarter turn", [](Vec3 v) { return Vec3{-v.y, v.x, v.z}; },
     [](std::int32_t i, std::int32_t j, std::int32_t n) { return Place{n - 1 - j, i}; }},
    {"a half turn", [](Vec3 v) { return Vec3{-v.x, -v.y, v.z}; },
     [](std::int32_t i, std::int32_t j, std::int32_t n) { return Place{n - 1 - i, n - 1 - j}; }}};

/// For motions that turn, both computations of an end are within the tolerance of small_block.
std::int32_t tolerance_quanta(const DexelGrid& grid) {
  return std::int32_t(0.01 / grid.z_quantum_mm);
}

TEST(Invariant, MirroredAndRotatedJobsAgree) {
  for (const NamedTool& t : every_tool(0.6)) {
    for (const Turning turning : {Turning::kNone, Turning::kSome}) {
      const std::vector<Move> moves = random_moves(41, 16, turning);
      Sculpture plain = carved(small_block(Rays::kDexel), t.tool, moves);
      const DexelSnapshot snapshot = plain.snapshot();
      const std::int32_t n = snapshot.grid().columns_x;
      for (const Symmetry& symmetry : kSymmetries) {
        std::vector<Move> image;
        for (const Move& m : moves) {
          const auto pose = [&](const ToolPose& p) {
            return ToolPose{symmetry.of(p.tip_mm), symmetry.of(p.axis)};
          };
          image.push_back({pose(m.from), pose(m.to)});
        }
        Sculpture other = carved(small_block(Rays::kDexel), t.tool, image);
        expect_equal_to_rounding(
            difference(snapshot, other.snapshot(),
                       [&](std::int32_t i, std::int32_t j) { return symmetry.place(i, j, n); }),
            t.name + " " + symmetry.name + (turning == Turning::kNone ? "" : ", turning"),
            turning == Turning::kNone ? kRoundingQuanta : tolerance_quanta(snapshot.grid()));
      }
    }
  }
}

TEST(Invariant, JobsMovedByWholePitchesAgree) {
  const Vec3 shift{64 * 0.75, -128 * 0.75, 32};
  for (const NamedTool& t : every_tool(0.6)) {
    for (const Turning turning : {Turning::kNone, Turning::kSome}) {
      const std::vector<Move> moves = random_moves(43, 16, turning);
      std::vector<Move> moved;
      for (const Move& m : moves) {
        moved.push_back({{m.from.tip_mm + shift, m.from.axis}, {m.to.tip_mm + shift, m.to.axis}});
      }
      SculptureSettings there = small_block(Rays::kDexel);
      auto& box = std::get<BoxStock>(there.stock);
      box = {box.min_mm + shift, box.max_mm + shift};
      Sculpture a = carved(small_block(Rays::kDexel), t.tool, moves);
      Sculpture b = carved(there, t.tool, moved);
      expect_equal_to_rounding(
          difference(a.snapshot(), b.snapshot(),
                     [](std::int32_t i, std::int32_t j) { return Place{i, j}; }),
          t.name, turning == Turning::kNone ? kRoundingQuanta : tolerance_quanta(a.grid()));
    }
  }
}

TEST(Invariant, ThreeFieldsHoldTheSameSolid) {
  // Samples of a column of one field: it may differ from the true solid by the tolerance only, so
  // the fields differ from one another by at most twice that.
  for (const NamedTool& t : every_tool(0.6)) {
    const std::vector<Move> moves = random_moves(51, 10);
    Sculpture alone = carved(small_block(Rays::kDexel), t.tool, moves);
    Sculpture three = carved(small_block(Rays::kTriDexel), t.tool, moves);
    EXPECT_EQ(alone.snapshot().hash(), three.snapshot(RayAxis::kZ).hash())
        << t.name << ": the field along Z is the same with and without the others";
    const double volume = three.snapshot(RayAxis::kZ).volume_mm3();
    for (const RayAxis axis : {RayAxis::kX, RayAxis::kY}) {
      EXPECT_NEAR(three.snapshot(axis).volume_mm3() / volume, 1, 0.01) << t.name;
    }
  }
}

}  // namespace
}  // namespace kerf::test::invariant_test
