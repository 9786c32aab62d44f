// SPDX-License-Identifier: Apache-2.0
#include "kernel/math/rotation.h"
#include "server/formats/forces_csv.h"
#include "tests/formats/scene_fixture.h"
#include "tests/support/test.h"

namespace kerf::feed_sampler_test {
namespace {

using test::gcode;
using test::scene_for;

TEST(FeedSampler, EveryMotionLastsOnePeriod) {
  const Program program =
      gcode(scene_for("xyz"), "T1 M6\nG0 X0 Y0 Z0\nG1 X10 F600\nY10\nG4 P0.5\nX0\nM2\n");
  const Program sampled = sample_program(program, 100);
  EXPECT_EQ(sampled.motions.size(), 350u);
  EXPECT_EQ(sample_count(program, 100), 350);
  for (const ProgramMotion& motion : sampled.motions) {
    EXPECT_NEAR(motion.duration_s, 0.01, 1e-12);
    const double travel_mm = length(motion.to.tip_mm - motion.from.tip_mm);
    EXPECT_TRUE(std::abs(travel_mm - 0.1) < 1e-9 || travel_mm < 1e-9) << travel_mm;
  }
  EXPECT_EQ(sampled.motions[99].to.tip_mm, (Vec3{10, 0, 0}));
  EXPECT_EQ(sampled.motions[99].line, 3u);
  EXPECT_EQ(sampled.motions[100].line, 4u);
  EXPECT_EQ(sampled.motions.back().to, program.motions.back().to);
}

TEST(FeedSampler, LastSampleOfAChainMayBeShorter) {
  const Program program = gcode(
      scene_for("xyz"), "T1 M6\nG0 X0 Y0 Z0\nG1 X1.05 F600\nG53 G0 Z0\nG0 X5\nZ0\nG1 X6\nM2\n");
  const Program sampled = sample_program(program, 100);
  ASSERT_EQ(sampled.motions.size(), 21u);
  EXPECT_NEAR(sampled.motions[10].duration_s, 0.005, 1e-12);
  EXPECT_EQ(sampled.motions[10].to.tip_mm, (Vec3{1.05, 0, 0}));
  EXPECT_EQ(sampled.motions[11].from.tip_mm, (Vec3{5, 0, 0}));
}

TEST(FeedSampler, SamplesConnectAndTurnLessThanTheKernelLimit) {
  const Program program =
      gcode(scene_for("tool-vector"),
            "T1 M6\nG0 X0 Y0 Z0\nG93\nG1 X5 I1 J0 K-1 F60\nX6 I0 J0 K1 F60\nM2\n");
  for (const double rate : {0.4, 1.0, 7.0}) {
    const Program sampled = sample_program(program, rate);
    double duration = 0;
    for (std::size_t i = 0; i < sampled.motions.size(); ++i) {
      const ProgramMotion& m = sampled.motions[i];
      EXPECT_EQ(m.from, i > 0 ? sampled.motions[i - 1].to : program.motions[0].from);
      EXPECT_LT(angle_between(normalized(m.from.axis), normalized(m.to.axis)), kTurnMaxRad);
      duration += m.duration_s;
    }
    EXPECT_NEAR(duration, 2, 1e-9);
    EXPECT_EQ(sampled.motions.back().to, program.motions.back().to);
  }
}

TEST(FeedSampler, WarnsOfCornersCutOff) {
  const Program program = gcode(scene_for("xyz"), "T1 M6\nG0 X0 Y0 Z0\nG1 X10.5 F60\nY10.5\nM2\n");
  EXPECT_TRUE(sample_program(program, 2).warnings.empty());
  const Program coarse = sample_program(program, 1);
  ASSERT_EQ(coarse.warnings.size(), 1u);
  EXPECT_EQ(coarse.warnings[0], "p.ngc: at this rate corners are cut off by up to 0.354 mm");
}

TEST(FeedSampler, EmptyProgramHasNoSamples) {
  EXPECT_TRUE(sample_program({}, 1000).motions.empty());
}

TEST(ForcesCsv, HasHeaderAndOneRowPerMotion) {
  std::ostringstream out;
  write_forces_header(out);
  MotionResult result{
      .wrench = {{0.1, 0, 1.0 / 3}, {0, -20, 0}}, .removed_mm3 = 1e-7, .imprint_mm3 = 5e-8};
  write_forces_row(out, 0.25, {{1, 2.5, -3}, {0, 0, 1}}, result);
  EXPECT_EQ(out.str(),
            "t_s,x,y,z,i,j,k,fx_n,fy_n,fz_n,tx_nmm,ty_nmm,tz_nmm,removed_mm3,"
            "imprint_mm3\n"
            "0.25,1,2.5,-3,0,0,1,0.1,0,0.333333333,0,-20,0,0.0000001,0.00000005\n");
}

TEST(ForcesCsv, FeltColumnsAreTheWrenchShortenedByOneFactor) {
  std::ostringstream out;
  const WrenchMaximum device{6, 150};
  write_forces_header(out, device);
  MotionResult result{.wrench = {{8, 0, 0}, {0, -600, 0}}};
  write_forces_row(out, 0.25, {{1, 2.5, -3}, {0, 0, 1}}, result, device);
  EXPECT_EQ(out.str(),
            "t_s,x,y,z,i,j,k,fx_n,fy_n,fz_n,tx_nmm,ty_nmm,tz_nmm,removed_mm3,"
            "imprint_mm3,felt_fx_n,felt_fy_n,felt_fz_n,felt_tx_nmm,felt_ty_nmm,felt_tz_nmm\n"
            "0.25,1,2.5,-3,0,0,1,8,0,0,0,-600,0,0,0,2,0,0,0,-150,0\n");
}

}  // namespace
}  // namespace kerf::feed_sampler_test
