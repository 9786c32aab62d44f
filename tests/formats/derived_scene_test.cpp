// SPDX-License-Identifier: Apache-2.0
#include "server/formats/derived_scene.h"

#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::derived_scene_test {
namespace {

DerivedScene derived(const std::string& program, const SceneWishes& wishes = {},
                     const GcodeEnvironment& environment = {}) {
  auto scene = derive_scene("part.nc", program, environment, wishes);
  EXPECT_TRUE(scene) << scene.error();
  return scene ? *std::move(scene) : DerivedScene{};
}

BoxStock box(const DerivedScene& derived) { return stock_bounds(derived.scene.settings.stock); }

double diameter(const DerivedScene& derived, ToolId id) {
  return 2 * derived.scene.tools.at(id).tool.radius_mm;
}

// A pocket floor from (10, 10) to (60, 40), 3 mm deep, approached through the air at feed rate.
constexpr const char* kPocket =
    "G21 G90\n(T1 D=8. CR=0. - flat end mill)\nT1 M6\nG0 Z15\nG0 X-40 Y-30\nG1 X10 Y10 F900\n"
    "G1 Z1\nG1 X14 Z-3\nG1 X60\nY40\nX10\nY10\nG1 Z15\nG1 X90 Y90\nM30\n";

TEST(DerivedScene, HasTheBoxOfTheCutsAndTheToolsOfTheComments) {
  const DerivedScene scene = derived(kPocket);
  EXPECT_EQ(box(scene).min_mm, (Vec3{6, 6, -5})) << "not the traverses at the height of Z15";
  EXPECT_EQ(box(scene).max_mm, (Vec3{64, 44, 0})) << "not where the tool comes down through air";
  EXPECT_EQ(diameter(scene, 1), 8);
  EXPECT_THAT(scene.notes, testing::Contains(testing::HasSubstr("comment in line 2")));
  EXPECT_THAT(scene.notes, testing::Contains(testing::HasSubstr("X 6 to 64, Y 6 to 44")));
  EXPECT_EQ(scene.scene.machine.kinematics, MachineKinematics::kXyz);
  ASSERT_TRUE(scene.scene.accuracy);
  EXPECT_EQ(scene.scene.accuracy->request.target_mm, 0.1) << "at least a thousandth of 58 mm";
}

/// Posts for machines without a tool changer write no T word.
TEST(DerivedScene, AProgramThatLoadsNoToolUsesTheOnlyOneThatItDescribes) {
  const std::string cuts = "G0 X0 Y0 Z5\nG1 Z-1 F100\nX9\nM2\n";
  EXPECT_EQ(diameter(derived("G21 G90\n(T14 D=3.175 CR=0. - flat end mill)\n" + cuts), 1), 3.175);
  EXPECT_EQ(diameter(derived("G21 G90\n(T14 D=3.175 CR=0. - flat end mill)\nT1 M6\n" + cuts), 1), 6)
      << "it loads another tool";
}

TEST(DerivedScene, ADoubtfulToolIsAssumed) {
  const std::string cuts = "G0 X0 Y0 Z5\nG1 Z-1 F100\nX9\n";
  const auto is_assumed = [&](const std::string& program) {
    return derived("G21 G90\n" + program + cuts + "M2\n").scene.tools.at(1).assumed;
  };
  EXPECT_FALSE(is_assumed("(T1 6mm END MILL)\nT1 M6\n"));
  EXPECT_TRUE(is_assumed("(T1 6mm END MILL 03-0086)\nT1 M6\n")) << "a word is not understood";
  EXPECT_TRUE(is_assumed("T1 M6\n")) << "nothing describes it";
  // FreeCAD's post for grbl writes tool changes as comments.
  const std::string first = "(6mm End Mill)\n( M6 T3 )\n";
  EXPECT_FALSE(is_assumed(first));
  EXPECT_TRUE(is_assumed(first + cuts + "(3mm End Mill)\n( M6 T4 )\n")) << "either may cut";
}

TEST(DerivedScene, RequestedValuesTakePrecedence) {
  SceneWishes wishes{.stock_size_mm = Vec3{70, 50, 10}, .tools = {{1, BallShape{4, 20}}}};
  const DerivedScene scene = derived(kPocket, wishes);
  EXPECT_EQ(box(scene).min_mm, (Vec3{0, 0, -10})) << "a corner at the origin holds the cuts";
  EXPECT_EQ(box(scene).max_mm, (Vec3{70, 50, 0}));
  EXPECT_EQ(diameter(scene, 1), 4);
  GcodeEnvironment table{.tools = ToolTable{{1, {.number = 1, .diameter_mm = 5}}}};
  EXPECT_EQ(diameter(derived(kPocket, {}, table), 1), 5);
}

TEST(DerivedScene, AnUnknownToolIsNamedInTheNotes) {
  const DerivedScene scene = derived("G21\nT5 M6\nG0 X0 Y0 Z5\nG1 Z-1 F100\nX30\nM30\n");
  EXPECT_EQ(diameter(scene, 5), kToolAssumedMm);
  EXPECT_THAT(scene.notes, testing::Contains(testing::HasSubstr("--tool 5=")));
}

TEST(DerivedScene, AToolThatNeverMovesDoesNotCountForTheAccuracy) {
  const std::string program = "G21 G90\n(T1 D=10 end mill)\nT1 M6\nG0 X0 Y0 Z5\nG1 Z-2 F100\nX50\n";
  const Scene alone = derived(program + "X60\nM2\n").scene;
  const Scene spare = derived("(T2 D=0.01 ball end mill)\n" + program + "T2\nX60\nM2\n").scene;
  EXPECT_EQ(spare.tools.at(2).tool.radius_mm, 0.005);
  EXPECT_EQ(spare.settings.pitch_mm, alone.settings.pitch_mm);
  const Scene used = derived("(T2 D=0.01 ball end mill)\n" + program + "T2 M6\nX60\nM2\n").scene;
  EXPECT_LE(used.settings.pitch_mm, 0.05);
}

TEST(DerivedScene, ToolsReachFromTheDeepestCutToTheTop) {
  const DerivedScene scene = derived("G21\nG0 X0 Y0 Z5\nG1 Z-80 F100\nX30\nM30\n");
  EXPECT_GE(scene.scene.tools.at(1).tool.length_mm, 80);
}

TEST(DerivedScene, StatedSizeSmallerThanTheCutsIsIgnored) {
  const std::string body = "G21\nG0 X0 Y0 Z5\nG1 Z-1 F100\nX300\nM30\n";
  const DerivedScene far = derived("(STOCK X100 Y50 Z20)\n" + body);
  EXPECT_GE(box(far).max_mm.x, 300);
  EXPECT_THAT(far.notes, testing::Contains(testing::HasSubstr("does not hold the cuts")));
  const DerivedScene held = derived("(STOCK X310 Y50 Z20)\n" + body);
  EXPECT_EQ(box(held).min_mm, (Vec3{0, 0, -20}));
  EXPECT_EQ(box(held).max_mm, (Vec3{310, 50, 0}));
}

TEST(DerivedScene, ZeroIsTheTableIfMostCutsAreAboveIt) {
  const DerivedScene scene =
      derived("G21\nG0 X0 Y0 Z40\nG1 Z18.5 F300\nX50\nY9\nX0\nZ12\nX50\nZ-0.2\nX0\nG0 Z40\nM30\n");
  EXPECT_EQ(box(scene).min_mm.z, -1) << "cut through into the table";
  EXPECT_EQ(box(scene).max_mm.z, 19);
}

TEST(DerivedScene, BoxOfADrillingProgramContainsTheHoles) {
  const DerivedScene scene =
      derived("G21\nT1 M6\nG0 X0 Y0 Z20\nG98 G81 X5 Y5 Z-8 R2 F90\nX25\nG80\nM30\n");
  EXPECT_EQ(box(scene).max_mm, (Vec3{28, 8, 0}));
  EXPECT_EQ(box(scene).min_mm.z, -10);
}

TEST(DerivedScene, ReadsTheKlartextBlankOnlyFromNumbers) {
  const auto stock = [](const std::string& head, const std::string& second) {
    return box(derived(head +
                       "BEGIN PGM T MM\nQ1 = 100\nBLK FORM 0.1 Z X-10 Y-10 Z-20\n"
                       "BLK FORM 0.2 " +
                       second +
                       "\nTOOL CALL 1 Z S1000\nL X+0 Y+0 Z+5 R0 FMAX M3\nL Z-1 F100\nL X+80\n"
                       "END PGM T MM\n"));
  };
  const BoxStock stated{{-10, -10, -20}, {100, 90, 0}};
  EXPECT_EQ(stock("", "X+100 IY+100,0 Z+0").max_mm, stated.max_mm);
  EXPECT_EQ(stock("\xEF\xBB\xBF", "X+100 Y+90 Z+0").max_mm, stated.max_mm) << "byte order mark";
  for (const char* other : {"X+Q1 Y+Q1 Z+0", "X+100 Y+90", "X+100 Y+90 Z+ Q1", "X+100 Y+90 Z+0 W5"})
    EXPECT_EQ(stock("", other).max_mm, (Vec3{83, 3, 0})) << other << ": the box of the cuts";
}

TEST(DerivedScene, QuestionsTheUnitOfATinyModel) {
  const test::TemporaryFolder folder;
  // A tetrahedron with sides of `s`.
  const auto notes = [&](const std::string& s) {
    const std::string o = "vertex 0 0 0\n", x = "vertex " + s + " 0 0\n",
                      y = "vertex 0 " + s + " 0\n", z = "vertex 0 0 " + s + "\n";
    std::string text = "solid t\n";
    for (const std::string& facet : {o + y + x, o + x + z, o + z + y, x + y + z})
      text += "facet normal 0 0 0\nouter loop\n" + facet + "endloop\nendfacet\n";
    std::ofstream(folder / "t.stl") << text << "endsolid t\n";
    SceneWishes wishes{.stock_file = "t.stl", .folder = folder.path()};
    return derived(kPocket, wishes).notes;
  };
  EXPECT_THAT(notes("0.04"), testing::Contains(testing::HasSubstr("stock.placement.unit")));
  EXPECT_THAT(notes("40"), testing::Not(testing::Contains(testing::HasSubstr("placement"))));
}

TEST(DerivedScene, ErrorsComeFromTheProgram) {
  EXPECT_THAT(derive_scene("p.nc", "G21\nG0 X1\nM30\n", {}, {}).error(),
              testing::HasSubstr("cuts nothing"));
  EXPECT_THAT(derive_scene("p.nc", "G21\nG77\n", {}, {}).error(), testing::HasSubstr("p.nc:2"));
  SceneWishes wishes{.tools = {{99, FlatShape{6, 30}}}};
  EXPECT_EQ(derive_scene("p.nc", kPocket, {}, wishes).error(),
            "p.nc: has no tool 99, which --tool states; its tools are 1");
  wishes = {};
  wishes.stock_file = "none.stl";
  EXPECT_THAT(derive_scene("p.nc", kPocket, {}, wishes).error(),
              testing::HasSubstr("cannot be read"));
}

}  // namespace
}  // namespace kerf::derived_scene_test
