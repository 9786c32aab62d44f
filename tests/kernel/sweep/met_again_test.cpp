// SPDX-License-Identifier: Apache-2.0
// Rays that a moving slice hits late, leaves or hits again, and the cost of evaluating them.

#include "kernel/cut/swept_block.h"
#include "kernel/sweep/swept_tool.h"
#include "kernel/tool/tool.h"
#include "tests/support/test.h"

namespace kerf::met_again_test {
namespace {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double in(double a, double b) { return std::uniform_real_distribution<double>(a, b)(engine_); }
  double power(double a, double b) { return std::pow(10.0, in(a, b)); }
  Vec3 vec() { return {in(-1, 1), in(-1, 1), in(-1, 1)}; }

 private:
  std::mt19937_64 engine_;
};

/// 32 x 32 columns around the Z axis, from −6 mm to 0.
DexelGrid grid_of(double pitch_mm) {
  DexelGrid grid{.origin_mm = {-16 * pitch_mm, -16 * pitch_mm, -6}, .pitch_mm = pitch_mm};
  grid.columns_x = grid.columns_y = 32;
  grid.height_quanta = 1 << 29;
  grid.z_quantum_mm = 6.0 / (1 << 29);
  return grid;
}

struct Work {
  std::int64_t most = 0;       ///< ColumnBlock::stations, per block and sub-motion
  std::size_t most_apart = 0;  ///< entries for separate intervals, per block
};

/// Sweeps a tool over an uncut stock.
Work work_of(const Tool& tool, const ToolPose& from, const ToolPose& to, double pitch_mm,
             double tolerance_mm) {
  const DexelGrid grid = grid_of(pitch_mm);
  const double half = 16 * pitch_mm;
  const SweepSettings settings{
      MotionModel::kTight, tolerance_mm, {{-half, -half, -6}, {half, half, 0}}};
  const ToolMotion motion = make_motion(from, to, tool.length_mm);
  Work work;
  ColumnBlock block;
  sweep_tool(tool, motion, settings, [&](const SubMotion& sub) {
    for (int k = 0; k < kTileBlocks; ++k) {
      const std::int64_t before = block.stations;
      sweep_block(sub.swept, grid, nullptr, k % kTileBlocksAcross * kBlockSide,
                  k / kTileBlocksAcross * kBlockSide, block);
      work.most =
          std::max(work.most, (block.stations - before) / std::max(sub.count, std::int64_t{1}));
      work.most_apart = std::max(work.most_apart, block.apart.size());
    }
  });
  return work;
}

/// Grazing rows took up to 2^16 stations for each of their rays, and 4,096 shares in each gap.
constexpr std::int64_t kMeetingsMax = 1 << 14;
/// Limits for a block whose rays the tool grazes for long. With 64 shares before every doubling of
/// the depth that may be missed, the motions below took up to 1,048 and 1,623.
constexpr std::int64_t kGrazedMeetingsMin = 200, kGrazedMeetingsMax = 800;
/// Limit for a block whose rays pass a disc of a piece across them. Without a bound for these rays
/// the motions below took up to 219 and 105.
constexpr std::int64_t kPassedMeetingsMax = 30;

TEST(MetAgain, PlungePastAThinShelfNeedsFewEvaluations) {
  const auto tool = make_tool(
      ProfileShape{{ProfilePoint{3.49238522, 0}, ProfilePoint{3.55352746, 1.79575729},
                    ProfilePoint{2.18959022, 1.90149829}, ProfilePoint{2.73861209, 1.90149829},
                    ProfilePoint{2.73861209, 26.9014983}}});
  ASSERT_TRUE(tool);
  const ToolPose from{{3.3729262179685917, -1.1868581337104469, -6.3553961488073085}, {0, 0, 1}};
  const ToolPose to{{3.3847884200206844, -1.1830430419141984, -10.028028495660916},
                    {-0.00016901341612678142, -0.00031221611086185082, 0.99999993697778067}};
  for (const double tolerance : {1e-6, 1e-4, 0.01, 1.02125}) {
    const Work work = work_of(*tool, from, to, 0.0162465, tolerance);
    EXPECT_LE(work.most, kMeetingsMax) << tolerance;
    EXPECT_LE(work.most_apart, 64U) << tolerance;
  }
}

TEST(MetAgain, ArcGrazingForAThousandTolerancesNeedsFewEvaluations) {
  struct Graze {
    ToolShape shape;
    double pitch_mm, tolerance_mm;
    ToolPose from, to;
  };
  // Found by a search for expensive motions.
  const double r = 7.96363796, w = 0.497950018;
  const Graze grazes[] = {
      {BullNoseShape{7.97693892, 1.99758287, 30},
       0.00149548002,
       5.40901935e-06,
       {{-2.706706967812655, -3.4874613128254701, 0},
        {0.97355533696222352, -0.20062120596416352, 0.10927551230653668}},
       {{-2.2501528447013026, -2.9600148838894711, -1.1475384665822668},
        {0.97355596018669877, -0.20061427156186493, 0.10928269044390047}}},
      {ProfileShape{{ProfilePoint{r, 0}, ProfileArc{{r, w}, w}, ProfilePoint{0.5, w},
                     ProfilePoint{0.5, 20}}},
       0.0375548199,
       7.81497405e-05,
       {{3.0026903390543307, 0.34965334835201622, 0},
        {0.14233856283720922, -0.98981424692648412, 0.002736806678387574}},
       {{-1.4429085116810239, 0.38938846526865833, -4.2805017980021356},
        {0.14233674615965888, -0.98981455484891412, 0.0027198716746887658}}},
      {BullNoseShape{2.1863353992803587, 0.00142913053, 30},
       0.0441250305,
       0.00651118621,
       {{1.4647785454361568, -1.0393618778346791, -1.9206966589043639},
        {0.03562446163531021, 0.01268192338053744, -0.99928477750467337}},
       {{1.4586207438548608, -1.0483497608055308, -1.8705707363329998},
        {0.20057809577980323, 0.40432748926169065, -0.89234954413653722}}},
  };
  std::int64_t most = 0;
  for (const Graze& g : grazes) {
    const auto tool = make_tool(g.shape);
    ASSERT_TRUE(tool);
    most = std::max(most, work_of(*tool, g.from, g.to, g.pitch_mm, g.tolerance_mm).most);
  }
  EXPECT_GT(most, kGrazedMeetingsMin);
  EXPECT_LE(most, kGrazedMeetingsMax);
}

TEST(MetAgain, ShelfGrazingForAThousandTolerancesNeedsFewEvaluations) {
  struct Graze {
    double radius_mm, width_mm, pitch_mm, tolerance_mm;
    ToolPose from, to;
  };
  // Found by a search for expensive motions. 4,096 evaluations of a ray were not enough.
  const Graze grazes[] = {
      {3.36780459,
       0.0719437018,
       0.00400067761,
       0.00176165313,
       {{-0.60074151854328217, 2.3268740966337056, -1},
        {-0.90062591524468494, 0.052663068690542512, 0.43139258452802481}},
       {{0.62600759694461161, 4.9209010872598702, -6.0241495215907905},
        {-0.90040420975142776, 0.053270491565999785, 0.43178063155985119}}},
      {5.55401719,
       0.000376229566,
       0.172857691,
       2.42591232e-06,
       {{-0.30530913080619637, 3.0781122645781673, 0},
        {-0.90820325297456661, 0.19557767570623799, 0.37002192374474385}},
       {{-0.38291389531290776, 3.0578237614459707, -0.039107935683346584},
        {-0.90819070808302094, 0.19557155571583157, 0.37005594758975369}}},
      {1,
       0.0154643474,
       0.00713091242,
       0.000128100226,
       {{0.97420845287339108, -0.42711006573158272, -1.9455424443667604},
        {-0.015390834771513475, -0.012245680223942918, 0.99980656405171142}},
       {{0.97326633737170032, -0.426029951689542, -1.9444554790814277},
        {0.061800179599934453, 0.010477966804158785, 0.99803354152707036}}},
      {4.1262616705653539,
       0.000951302422,
       0.0310343629,
       0.00844464823,
       {{0.09778415237672991, 0.16105761502409088, 2.6588629842913623},
        {0.9870199796830087, -0.159718652478643, -0.016778312101035912}},
       {{0.097718717920970921, 0.16099135460718067, 2.6589016699984493},
        {0.98194121919903388, -0.032566960737753239, 0.18636210748491897}}},
  };
  std::int64_t most = 0;
  for (const Graze& g : grazes) {
    const double r = g.radius_mm, w = g.width_mm;
    const auto tool = make_tool(ProfileShape{{ProfilePoint{r * 0.7, 0}, ProfilePoint{r, w},
                                              ProfilePoint{1, w * 1.5}, ProfilePoint{1, 20}}});
    ASSERT_TRUE(tool);
    most = std::max(most, work_of(*tool, g.from, g.to, g.pitch_mm, g.tolerance_mm).most);
  }
  EXPECT_GT(most, kGrazedMeetingsMin);
  EXPECT_LE(most, kGrazedMeetingsMax);
}

TEST(MetAgain, RaysPassingADiscNeedFewEvaluations) {
  // A ball end mill and a flat one with axes across the rays move along themselves and turn by 2.5
  // degrees, as seen by rays of a field across the spindle: below the hidden disc on which the
  // cylinder continues the ball, and below the bottom of the flat mill.
  for (const bool is_ball : {true, false}) {
    const auto tool = is_ball ? make_tool(BallShape{10, 40}) : make_tool(FlatShape{10, 40});
    ASSERT_TRUE(tool);
    const double tip = is_ball ? -5 : 0;
    std::int64_t met = 0;
    for (const double lean : {-0.2, -0.1, -0.02, 0.0, 0.02, 0.1, 0.2}) {
      const Vec3 axis = normalized(Vec3{1, 0.1, lean}), to = normalized(Vec3{1, 0.1, lean + 0.044});
      for (const Vec3 step : {Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{0.1, 0.7, 0.7}}) {
        const Vec3 at = Vec3{0, 0, -3} + axis * tip;
        met = std::max(met, work_of(*tool, {at, axis}, {at + step, to}, 0.1, 0.001).most);
      }
    }
    EXPECT_GT(met, 0);
    EXPECT_LE(met, kPassedMeetingsMax) << is_ball;
  }
}

TEST(MetAgain, PieceTurningAboutItsAxisPointIsSweptOnce) {
  // Its halves move in opposite directions, but need no sweeps of their own.
  const auto tool = make_tool(FlatShape{10, 40});
  ASSERT_TRUE(tool);
  const ToolPose from{{0, 0, -4}, {0, 0, 1}};
  const Vec3 axis = normalized(Vec3{0.1, 0, 1});
  const ToolPose to{from.tip_mm + (from.axis - axis) * 2, axis};
  const SweepSettings settings{MotionModel::kTight, 0.001, {{-8, -8, -6}, {8, 8, 0}}, true};
  std::size_t sweeps = 0, pieces = 0;
  std::int64_t sub_motions = 0;
  sweep_tool(*tool, make_motion(from, to, tool->length_mm), settings, [&](const SubMotion& part) {
    ++sweeps;
    pieces += part.swept.pieces.size();
    sub_motions += part.count;
  });
  EXPECT_EQ(sweeps, 1U);
  EXPECT_EQ(pieces, 1U);
  EXPECT_GT(sub_motions, 1);
}

/// Tools with thin discs, shelves and needles.
ToolShape thin_shape(int k, Random& random) {
  const double r = random.in(1, 6), w = random.power(-5, -0.5);
  switch (k % 4) {
    case 0:
      return ProfileShape{
          {ProfilePoint{r, 0}, ProfilePoint{r, w}, ProfilePoint{0.5, w}, ProfilePoint{0.5, 20}}};
    case 1:
      return ProfileShape{{ProfilePoint{r * 0.7, 0}, ProfilePoint{r, w}, ProfilePoint{1, w * 1.5},
                           ProfilePoint{1, 20}}};
    case 2:
      return ProfileShape{{ProfilePoint{w, 0}, ProfilePoint{2 * w, random.in(1, 20)}}};
    default:
      return ProfileShape{
          {ProfilePoint{r, 0}, ProfileArc{{r, w}, w}, ProfilePoint{0.5, w}, ProfilePoint{0.5, 20}}};
  }
}

TEST(MetAgain, ThinToolsNeedFewEvaluationsInAnyMotion) {
  Random random(11);
  int met = 0;
  for (int k = 0; k < 1200; ++k) {
    const auto tool = make_tool(thin_shape(k, random));
    if (!tool) continue;
    const double pitch = random.power(-2.3, 0), tolerance = pitch * random.power(-4, 1);
    const double lean = k % 3 == 0 ? 0.01 : k % 3 == 1 ? 3 : 1000;
    const Vec3 axis = normalized(Vec3{random.in(-1, 1) * lean, random.in(-1, 1) * lean, 1});
    const Vec3 side = normalized(cross(axis, random.vec()));
    const double radius = extent(tool->pieces.front()).radius_mm;
    const ToolPose from{Vec3{0, 0, random.in(-4, 0)} - side * radius * random.in(0.9, 1), axis};
    ToolPose to = from;
    to.axis = normalized(axis + random.vec() * random.power(-5, -0.5));
    const double step = random.power(-3, 1);
    if (k % 5 == 0) to.tip_mm = from.tip_mm + Vec3{0, 0, k % 2 == 0 ? step : -step};
    if (k % 5 == 1) to.tip_mm = from.tip_mm + axis * step;
    if (k % 5 == 2) to.tip_mm = from.tip_mm + random.vec() * step;
    if (k % 5 == 3) to.tip_mm = from.tip_mm + axis * step - to.axis * step;
    const Work work = work_of(*tool, from, to, pitch, tolerance);
    EXPECT_LE(work.most, kMeetingsMax) << k;
    EXPECT_LE(work.most_apart, 64U) << k;
    met += work.most > 0 ? 1 : 0;
  }
  EXPECT_GT(met, 40);
}

}  // namespace
}  // namespace kerf::met_again_test
