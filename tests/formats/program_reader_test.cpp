// SPDX-License-Identifier: Apache-2.0
#include "server/formats/program_reader.h"

#include "server/formats/derived_scene.h"
#include "server/formats/gcode/program_flow.h"
#include "server/formats/program_survey.h"
#include "tests/formats/scene_fixture.h"
#include "tests/support/test.h"

namespace kerf::program_reader_test {
namespace {

using testing::HasSubstr;

/// More than one step may do: the pieces of a path, and the lines of a block.
constexpr std::size_t kStepMax = 200;

Scene scene_of(const std::string& kinematics) { return test::scene_for(kinematics, 0.001); }

/// Records the greatest number of motions passed at once.
class Counter final : public ProgramVisitor {
 public:
  void begin() override { motions = most = 0; }
  void visit(std::span<const ProgramMotion> some) override {
    motions += some.size();
    most = std::max(most, some.size());
  }
  std::size_t motions = 0, most = 0;
};

struct Sample {
  const char *name, *kinematics, *text;
};
const Sample kSamples[] = {
    {"lines.ngc", "xyz", "G21\nT1 M6\nG0 X0 Y0 Z5\nG1 Z-2 F100\nX10\nG4 P1\nM2\n"},
    {"cycles.ngc", "xyz",
     "G21\nT1 M6\nF100\nG0 X0 Y0 Z5\nG91 G81 X1 Y0 Z-2 R-1 L300\nG90 G83 X1 Z-5 R1 Q0.01\nG98 G82 "
     "X2 Z-1 R2 P1\nX3\nG80\nG0 X9\nM2\n"},
    {"arcs.ngc", "xyz",
     "G21\nT1 M6\nF100\nG0 X0 Y0 Z5\nG2 X10 I5 P40\nG3 X0 I-5\nG5 I1 J2 P3 Q-1 X4 Y4\nG4 P1\n"
     "G41.1 D2 G1 X20 Y20\nG3 X30 Y30 I0 J10\nG1 X40\nG40 X50\nM2\n"},
    {"loop.ngc", "xyz",
     "G21\nT1 M6\nF100\nG0 X0 Y0 Z5\n#1=0\nO1 while [#1 LT 700]\n#1=[#1+1]\nO2 if [#1 GT 650]\nG1 "
     "X#1\nO2 endif\nO1 endwhile\nM2\n"},
    {"macro.nc", "xyz",
     "%\nO1\nG21 T1 M6\nG0 X0 Y0 Z5 F100\nG2 X10 I5 M98 P2\nWHILE[#1LT500]DO1\n#1=#1+1\nEND1\nG65 "
     "P3 X7.\nM30\nO2\nG81 X1. Z-1. R1. K30 F50\nG80\nM99\nO3\nG1 X#24\nM99\n%\n"},
    {"turns.ngc", "xyzac-trt",
     "G21\nT1 M6\nF100\nG0 X0 Y0 Z5 A0 C0\nG1 A40 C700 X20\nG1 X0 A0\nM2\n"},
    {"part.h", "xyz",
     "BEGIN PGM A MM\nTOOL CALL 1 Z S1000\nL X+0 Y+0 Z+5 FMAX\nLBL 1\nL IX+1 Z-1 F100\nCALL LBL 1 "
     "REP 30/30\nCC X+0 Y+0\nCP IPA+7200 IZ-5 DR+\nEND PGM A MM\n"},
    {"part.apt", "xyz",
     "UNITS/MM\nLOADTL/1\nFEDRAT/100\nFROM/0,0,5\nGOTO/1,0,-1\nGODLTA/1,1,0\nDELAY/2\nFINI\n"}};

/// All motions of a stream.
std::vector<ProgramMotion> drained(MotionStream stream) {
  std::vector<ProgramMotion> motions;
  while (stream.read().value()) {
    for (; stream.next() != nullptr; stream.pop()) motions.push_back(*stream.next());
  }
  return motions;
}

TEST(ProgramReader, StepsGiveTheMotionsOfTheWholeProgram) {
  for (const Sample& sample : kSamples) {
    SCOPED_TRACE(sample.name);
    const Scene scene = scene_of(sample.kinematics);
    const auto program = test::value_of(parse_program(sample.name, sample.text, scene));
    EXPECT_GE(program.motions.size(), 2u);
    Counter counter;
    const auto read = test::value_of(read_program(sample.name, sample.text, scene, {}, counter));
    EXPECT_EQ(counter.motions, program.motions.size());
    EXPECT_LT(counter.most, kStepMax);
    EXPECT_EQ(read.notes.warnings, program.warnings);
    EXPECT_EQ(read.notes.files, program.files);
    EXPECT_EQ(drained(MotionStream(read.open(), std::nullopt)), program.motions);
    EXPECT_EQ(drained(MotionStream(read.open(), 100.0)), sample_program(program, 100).motions);
  }
}

TEST(ProgramReader, BlockWithManyMotionsIsReadInSteps) {
  const Scene scene = scene_of("xyz");
  const std::string begin = "G21\nT1 M6\nF100\nG0 X0 Y0 Z5\n";
  for (const std::string block :
       {"G81 X1 Z-1 R1 L30000", "G83 X1 Z-5 R1 Q0.0001", "G2 X10 I5 P900"}) {
    SCOPED_TRACE(block);
    Counter counter;
    const auto read = read_program("p.ngc", begin + block + "\nM2\n", scene, {}, counter);
    ASSERT_TRUE(read) << to_string(read.error());
    EXPECT_GT(counter.motions, 50'000u);
    EXPECT_LT(counter.most, kStepMax);
  }
}

TEST(ProgramReader, ALoopWithoutMotionsIsExecutedInManySteps) {
  const Scene scene = scene_of("xyz");
  for (const char* loop :
       {"#1=1\nO1 while [#1 LT 2]\nO1 endwhile\nM2\n", "%\nO1\nWHILE[1EQ1]DO1\nEND1\nM30\n%\n"}) {
    Counter counter;
    const auto error = test::error_of(read_program("p.ngc", loop, scene, {}, counter));
    EXPECT_THAT(to_string(error), HasSubstr("lines without a motion"));
  }
  std::string lines = "O1\nG21 T1 M6\nG0 X0 Y0 Z5\n";
  for (int n = 0; n < 20'000; ++n) lines += "N9\n";
  for (const std::string& text :
       {std::string("G21\nT1 M6\nG0 X0 Y0 Z5\nO1 repeat [20000]\nO1 endrepeat\nG1 X9 F100\nM2\n"),
        lines + "G1 X9. F100\nM30\n%\n"}) {
    Counter counter;
    const auto read = test::value_of(read_program("p.nc", text, scene, {}, counter));
    MotionStream stream(read.open(), std::nullopt);
    std::size_t steps = 0;
    while (stream.next() == nullptr) {
      ASSERT_TRUE(stream.read().value());
      ++steps;
    }
    EXPECT_GT(steps, 20'000u / kGcodeLinesPerStep);
  }
}

/// Ends the reading after this many queries.
class Impatient final : public ProgramVisitor {
 public:
  explicit Impatient(int patience) : patience_(patience) {}
  void begin() override {}
  void visit(std::span<const ProgramMotion>) override {}
  bool is_stopped() const override { return ++asked >= patience_; }
  mutable int asked = 0;

 private:
  int patience_;
};

// Each of these runs for seconds to its limit of lines or motions.
TEST(ProgramReader, EndsWithinOneStepOfAStop) {
  const Scene scene = scene_of("xyz");
  const Sample endless[] = {
      {"p.nc", "fanuc", "%\nO1\n#1=0\nWHILE[1EQ1]DO1\n#1=#1+1\nEND1\nM30\n%\n"},
      {"p.ngc", "linuxcnc", "#1=1\nO1 while [1]\n#1=[#1+1]\nO1 endwhile\nM2\n"},
      {"p.mpf", "siemens", "L1:\nR1=R1+1\nGOTOB L1\nM30\n"},
      {"p.h", "heidenhain",
       "BEGIN PGM A MM\nQ1 = 0\nLBL 1\nQ1 = Q1 + 1\nFN 9: IF +1 EQU +1 GOTO LBL 1\n"
       "END PGM A MM\n"}};
  for (const auto& [name, dialect, text] : endless) {
    SCOPED_TRACE(dialect);
    GcodeEnvironment environment{.dialect = dialect_of(dialect).value()};
    Impatient visitor(5);
    const auto error = test::error_of(read_program(name, text, scene, environment, visitor));
    EXPECT_THAT(to_string(error), HasSubstr("stopped"));
    EXPECT_EQ(visitor.asked, 5);
  }
}

TEST(ProgramReader, StopEndsReadingWithoutAScene) {
  std::stop_source stop;
  stop.request_stop();
  const std::string text = "G21\nT1 M6\nF100\nG0 X0 Y0 Z5\nG1 Z-1\nX9\nM2\n";
  ASSERT_TRUE(program_facts("p.ngc", text));
  const auto error = test::error_of(program_facts("p.ngc", text, {}, stop.get_token()));
  EXPECT_THAT(to_string(error), HasSubstr("stopped"));
  const auto derived = test::error_of(derive_scene("p.ngc", text, {}, {}, stop.get_token()));
  EXPECT_THAT(derived, HasSubstr("stopped"));
}

TEST(ProgramReader, ErrorWithinAPathNamesItsLine) {
  const Scene scene = scene_of("xyz");
  Counter counter;
  const auto error = test::error_of(
      read_program("p.ngc", "G21\nT1 M6\nF100\nG0 X0 Y0 Z5\nG2 X10 I5 P20 Z-10000000\nG1 X0\nM2\n",
                   scene, {}, counter));
  EXPECT_EQ(error.line, 5u);
  EXPECT_EQ(error.word, "G2 X10 I5 P20 Z-10000000");
  EXPECT_THAT(error.reason, HasSubstr("mm from the origin"));
  EXPECT_GT(counter.motions, 0u);
}

TEST(ProgramSurvey, CountsCarvedMotions) {
  const Scene scene = scene_of("xyz");
  const std::string text = kSamples[1].text;
  const auto program = test::value_of(parse_program("p.ngc", text, scene));
  for (const std::optional<double> rate_hz : {std::optional<double>(), std::optional(50.0)}) {
    const Program carved = rate_hz ? sample_program(program, *rate_hz) : program;
    ProgramSurvey survey(100, rate_hz);
    ASSERT_TRUE(read_program("p.ngc", text, scene, {}, survey));
    const ProgramTotals totals = survey.totals();
    double duration_s = 0;
    for (const ProgramMotion& motion : carved.motions) duration_s += motion.duration_s;
    EXPECT_EQ(totals.motions, carved.motions.size());
    EXPECT_EQ(totals.duration_s, duration_s);
    ASSERT_EQ(totals.tools.size(), 1u);
    EXPECT_EQ(totals.tools[0].line, carved.motions[0].line);
    EXPECT_EQ(survey.path().points, drawn_path(program, 100).points);
  }
}

TEST(ProgramSurvey, GivesUpAboveTheLimitOfSamples) {
  ProgramSurvey survey(100, 100.0);
  ASSERT_TRUE(read_program("p.ngc", "G21\nT1 M6\nG0 X0 Y0 Z5\nG1 X9 F100\nG4 P100000000\nM2\n",
                           scene_of("xyz"), {}, survey));
  EXPECT_GT(survey.duration_s() * 100, kSamplesMax);
}

TEST(FeedSampler, HoldsAWindowOfMotions) {
  FeedSampler sampler(1);
  std::vector<ProgramMotion> samples;
  ProgramMotion motion{.tool = 1, .duration_s = 1e-9};
  for (std::size_t n = 0; n < 3 * FeedSampler::kWindow; ++n) {
    ASSERT_FALSE(sampler.can_sample());
    sampler.add(motion);
    motion.from = motion.to;
    motion.to.tip_mm.x += 1e-6;
    while (sampler.can_sample()) sampler.sample(samples);
  }
  ASSERT_GE(samples.size(), 2u);
  EXPECT_EQ(samples[1].from, samples[0].to);
}

TEST(PathCollector, KeepsFewPointsOfALongPath) {
  PathCollector collector(500);
  ProgramMotion motion{.tool = 1};
  double far_mm = 0;
  constexpr int kMotions = 400'000;
  for (int n = 1; n <= kMotions; ++n) {
    motion.from = motion.to;
    const double turn = 40.0 * n / kMotions, radius = 50 + 0.01 * (n % 2);
    motion.to.tip_mm = {radius * std::cos(turn), radius * std::sin(turn), 0};
    far_mm = std::max(far_mm, length(motion.to.tip_mm));
    collector.add(motion);
  }
  const ProgramPath path = collector.take();
  EXPECT_LE(path.points.size(), 500u);
  EXPECT_GT(path.points.size(), 50u);
  EXPECT_LT(path.error_mm, 2);
  for (const PathPoint& point : path.points) {
    if (&point == path.points.data()) continue;  // the origin
    EXPECT_NEAR(length(point.tip_mm), 50, 0.02);
  }
  EXPECT_EQ(path.points.back().tip_mm, motion.to.tip_mm);
}

}  // namespace
}  // namespace kerf::program_reader_test
