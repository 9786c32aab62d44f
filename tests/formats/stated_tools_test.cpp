// SPDX-License-Identifier: Apache-2.0
#include "server/formats/stated_tools.h"

#include "server/formats/stated_stock.h"
#include "server/formats/tool_text.h"
#include "server/formats/tool_words.h"
#include "tests/support/test.h"

namespace kerf::stated_tools_test {
namespace {

std::string words(const std::string& text, double unit_mm = 1) {
  const auto tool = tool_of_words(text, unit_mm);
  return tool ? (tool->doubt.empty() ? "" : "? ") + tool_text(tool->shape) : "none";
}

std::map<ToolId, StatedTool> stated_tools(std::string_view program) {
  return kerf::stated_tools(program, program_unit_mm(program));
}

TEST(ToolWords, ReadPostprocessorComments) {
  EXPECT_EQ(words("D=6. CR=0. - ZMIN=-5. - flat end mill"), "flat, diameter 6 mm, length 30 mm");
  EXPECT_EQ(words("D=0.25 CR=0.125 - ball", 25.4), "ball, diameter 6.35 mm, length 31.75 mm");
  EXPECT_EQ(words("D=10 CR=1. - bull nose end mill"),
            "bull nose, diameter 10 mm, length 50 mm, corner radius 1 mm");
  EXPECT_EQ(words("D=5. CR=0. TAPER=118deg - ZMIN=-13 - drill"),
            "cone end, diameter 5 mm, length 25 mm, tip angle 118 degrees");
  EXPECT_EQ(words("D=6. CR=0. TAPER=45deg - ZMIN=-1 - chamfer mill"),
            "cone end, diameter 6 mm, length 30 mm, tip angle 90 degrees");
  EXPECT_EQ(words(" | 1/2 FLAT ENDMILL | H1 | D1 | DIA. - .5", 25.4),
            "flat, diameter 12.7 mm, length 63.5 mm");
  EXPECT_EQ(words("DIA. OFF. - 1 LEN. - 1 DIA. - 12."), "flat, diameter 12 mm, length 60 mm");
  EXPECT_EQ(words("ID=2 DIA-0.5 1/2 ENDMILL", 25.4), "flat, diameter 12.7 mm, length 63.5 mm");
  EXPECT_EQ(words("TOOL/MILL,3.18, 0.00, 20.00, 0.0"), "flat, diameter 3.18 mm, length 20 mm");
  EXPECT_EQ(words("TOOL/MILL,0.03, 0.00, 10.00, 15.00"),
            "taper with flat tip, diameter 0.03 mm, length 20 mm, half angle 15 degrees");
  EXPECT_EQ(words("TOOL/MILL,6.35, 3.17, 0.00, 0.00"), "ball, diameter 6.35 mm, length 31.75 mm");
}

TEST(ToolWords, ABareNumberNextToANamedDiameterIsADoubt) {
  EXPECT_EQ(words("10.0 dia. ENDMILLM1000:REG"), "? flat, diameter 10 mm, length 50 mm");
  EXPECT_EQ(words("D10 END MILL 7"), "? flat, diameter 10 mm, length 50 mm");
  EXPECT_EQ(words("D10 END MILL D7"), "none") << "two diameters";
}

TEST(ToolWords, FlutesMayBeCountedInWords) {
  EXPECT_EQ(words("3.175mm flat end mill (single flute)"), "flat, diameter 3.175 mm, length 20 mm");
  EXPECT_EQ(words("6 mm two flute ball nose"), "ball, diameter 6 mm, length 30 mm");
  EXPECT_EQ(words("two-flute 6mm ball nose"), "ball, diameter 6 mm, length 30 mm");
  EXPECT_EQ(words("FRAISE DEUX TAILLES D6"), "flat, diameter 6 mm, length 30 mm");
}

TEST(ToolWords, NumbersInWordsCountOnlyFlutes) {
  for (const char* text : {"D6 double end mill", "6mm single end mill", "two D6 end mill, 2 flutes",
                           "6mm four end mill", "D6 end mill flutes three", "FRAISE D6 DEUX"})
    EXPECT_EQ(words(text), "? flat, diameter 6 mm, length 30 mm") << text;
  EXPECT_EQ(words("double 6"), "none");
  const auto tool = test::value_of(tool_of_words("D6 double end mill", 1));
  EXPECT_EQ(tool.doubt, "\"DOUBLE\" is not understood");
  EXPECT_EQ(tool.origins, ToolOrigins{});
}

TEST(ToolWords, ReadHandWrittenComments) {
  EXPECT_EQ(words("5mm Endmill001"), "flat, diameter 5 mm, length 25 mm");
  EXPECT_EQ(words("1/4\" ball nose, 2 flute"), "ball, diameter 6.35 mm, length 31.75 mm");
  EXPECT_EQ(words("1-1/4 face mill"), "flat, diameter 31.75 mm, length 158.75 mm");
  EXPECT_EQ(words("face a 9.9x9in block with a 1/4 endmill"), "none") << "an operation";
  EXPECT_EQ(words("- SIDE MILL D10 L35 SD10"), "flat, diameter 10 mm, length 50 mm");
  EXPECT_EQ(words("3 mm drill"), "cone end, diameter 3 mm, length 20 mm, tip angle 118 degrees");
  EXPECT_EQ(words("V-Bit 60 deg 10mm"),
            "cone end, diameter 10 mm, length 50 mm, tip angle 60 degrees");
  EXPECT_EQ(words("M10x1.5 TAP"), "flat, diameter 10 mm, length 50 mm");
}

TEST(ToolWords, StateTheDiameterAndNotAnotherLength) {
  EXPECT_EQ(words("6,35mm ball"), "ball, diameter 6.35 mm, length 31.75 mm");
  EXPECT_EQ(words("D6,35 ball"), "ball, diameter 6.35 mm, length 31.75 mm");
  EXPECT_EQ(words("1/4,2 flute"), "flat, diameter 6.35 mm, length 31.75 mm");
  EXPECT_EQ(words("TOOL/MILL,6,0,20,30"), words("TOOL/MILL,6, 0, 20, 30"));
  EXPECT_EQ(words("3/8-16 TAP"), "flat, diameter 9.525 mm, length 47.625 mm");
  EXPECT_EQ(words("#10-32 TAP"), "flat, diameter 4.826 mm, length 24.13 mm");
  EXPECT_EQ(words("- 1 1/4 FACE MILL", 25.4), "flat, diameter 31.75 mm, length 158.75 mm");
  EXPECT_EQ(words("DIA 1 1/4", 25.4), "flat, diameter 31.75 mm, length 158.75 mm");
  EXPECT_EQ(words("H1 D1 1/4 ENDMILL", 25.4), "flat, diameter 6.35 mm, length 31.75 mm");
  EXPECT_EQ(words("TOOL 1 1/4 ENDMILL", 25.4), "flat, diameter 6.35 mm, length 31.75 mm");
  EXPECT_EQ(words("L=75mm END MILL D8"), "flat, diameter 8 mm, length 40 mm");
  EXPECT_EQ(words("75mm LONG END MILL D8"), "flat, diameter 8 mm, length 40 mm");
  EXPECT_EQ(words("END MILL 8mm LENGTH 75"), "flat, diameter 8 mm, length 40 mm");
  EXPECT_EQ(words("6mm x 30mm endmill"), "flat, diameter 6 mm, length 30 mm");
}

TEST(ToolWords, EveryOptionWordIsUnderstood) {
  const auto exact = [](const char* text) {
    const auto shape = tool_of_exact_words(text);
    return shape ? tool_text(*shape) : "none";
  };
  EXPECT_EQ(exact("6"), "flat, diameter 6 mm, length 30 mm");
  EXPECT_EQ(exact("6,35 mm ball"), "ball, diameter 6.35 mm, length 31.75 mm");
  EXPECT_EQ(exact("1/4 in ball nose, 2 flutes"), "ball, diameter 6.35 mm, length 31.75 mm");
  EXPECT_EQ(exact("1 1/4"), "flat, diameter 31.75 mm, length 158.75 mm");
  EXPECT_EQ(exact("D=10 CR=1 bull nose"),
            "bull nose, diameter 10 mm, length 50 mm, corner radius 1 mm");
  EXPECT_EQ(exact("60 deg v-bit"), "cone end, diameter 10 mm, length 50 mm, tip angle 60 degrees");
  EXPECT_EQ(exact("3 mm drill"), "cone end, diameter 3 mm, length 20 mm, tip angle 118 degrees");
  EXPECT_EQ(exact("M10 tap"), "flat, diameter 10 mm, length 50 mm");
  EXPECT_EQ(exact("#7 drill"),
            "cone end, diameter 5.1054 mm, length 25.527 mm, tip angle 118 degrees");
  EXPECT_EQ(exact("3/8-16 TAP"), "flat, diameter 9.525 mm, length 47.625 mm");
  for (const char* text : {"6x30 endmill",
                           "1e9",
                           "-6",
                           "+6",
                           "60 deg",
                           "6 mm ball 60 deg",
                           "6 8 ball",
                           "6 ball of steel",
                           "0",
                           "",
                           "ball",
                           "6-8",
                           "6,7,8",
                           "L=75mm mill D8",
                           "M6 ball",
                           "D=6 CR=9 drill",
                           "6 ft",
                           "6=",
                           "6;",
                           "501"})
    EXPECT_EQ(exact(text), "none") << text;
}

TEST(StatedTools, AShopNumberIsADoubtAndNoSize) {
  for (const char* text : {"G21\n(T1 = 1/2\" END MILL 03-0086)\nT1 M6\nG1 X1\n",
                           "G20\n(T1 .5 ENDMILL 03-0086)\nT1 M6\nG1 X1\n"}) {
    const auto tools = stated_tools(text);
    ASSERT_TRUE(tools.contains(1)) << text;
    EXPECT_EQ(tool_text(tools.at(1).shape), "flat, diameter 12.7 mm, length 63.5 mm") << text;
    EXPECT_NE(tools.at(1).doubt, "") << text;
  }
}

/// The post of FreeCAD for grbl writes the tool changes as comments.
TEST(StatedTools, OfTwoToolsWithoutNumbersNeitherIsCertain) {
  const auto tools =
      stated_tools("G21\n(3mm Endmill)\n( M6 T1 )\nG1 X1\n(1.5mm Endmill)\n( M6 T2 )\nG1 X2\n");
  ASSERT_TRUE(tools.contains(1));
  EXPECT_EQ(tools.at(1).doubt, "line 2 describes another tool");
  const auto same = stated_tools("G21\n(3mm Endmill)\nG1 X1\n(3mm Endmill)\nG1 X2\n");
  EXPECT_EQ(same.at(1).doubt, "");
}

TEST(ToolWords, RequireASize) {
  for (const char* text : {"FLAT END MILL", "ENDMILL | H1 | D1", "2 flutes", "feed 300", "", "D="})
    EXPECT_EQ(words(text), "none") << text;
}

TEST(StatedTools, ComeWithTheirNumbers) {
  const auto tools = stated_tools(
      "%\nO1\n(T1 D=6. CR=0. - flat end mill)\n(TOOL - 2 DIA. - 4.)\n(Tools: T3 2mm drill)\n"
      "(T4 3MM BALL (NEW))\n(TOOL 6MM ENDMILL IS NOT A NUMBER)\nG21\nT1 M6\nG1 X1\nT9 M6\n");
  ASSERT_EQ(tools.size(), 4U);
  EXPECT_EQ(tool_text(tools.at(1).shape), "flat, diameter 6 mm, length 30 mm");
  EXPECT_EQ(tools.at(1).line, 3U);
  EXPECT_EQ(tool_text(tools.at(2).shape), "flat, diameter 4 mm, length 20 mm");
  EXPECT_EQ(tool_text(tools.at(4).shape), "ball, diameter 3 mm, length 20 mm");
  EXPECT_EQ(tool_text(tools.at(3).shape),
            "cone end, diameter 2 mm, length 20 mm, tip angle 118 degrees");
}

TEST(StatedTools, UnnumberedCommentsDescribeTheNextOrLoadedTool) {
  const auto tools = stated_tools(
      "G21\n(TC: 5mm Endmill)\n(Begin toolchange)\nM5\nM6 T2\nG1 X3\n(2mm drill here)\n"
      "T7 M6\nG1 X4\nT8 M6\n(1/8 ENDMILL)\nG1 X5\n(4mm drill at the end)\n");
  ASSERT_EQ(tools.size(), 3U);
  EXPECT_EQ(tool_text(tools.at(2).shape), "flat, diameter 5 mm, length 25 mm");
  EXPECT_EQ(tool_text(tools.at(7).shape),
            "cone end, diameter 2 mm, length 20 mm, tip angle 118 degrees");
  EXPECT_EQ(tool_text(tools.at(8).shape), "flat, diameter 3.175 mm, length 20 mm");
}

TEST(StatedTools, ProgramWithoutNumbersHasOneTool) {
  const auto tools = stated_tools("G20\n(Tool diameter: 0.125)\nG1 X1\n");
  ASSERT_TRUE(tools.contains(1));
  EXPECT_EQ(tool_text(tools.at(1).shape), "flat, diameter 3.175 mm, length 20 mm");
}

TEST(StatedTools, KlartextToolsUseTheUnitOfTheFirstBlock) {
  const auto flat = [](const std::string& head) {
    const auto tools =
        stated_tools(head + "\n; T1 D=0.25 - flat end mill\nTOOL CALL 1 Z\nL X1 F9\n");
    return tools.contains(1) ? tool_text(tools.at(1).shape) : "none";
  };
  EXPECT_EQ(flat("0 BEGIN PGM T INCH"), "flat, diameter 6.35 mm, length 31.75 mm");
  EXPECT_EQ(flat("BEGIN PGM G20 MM"), "flat, diameter 0.25 mm, length 20 mm") << "G20 is a name";
  EXPECT_EQ(flat("%\n0 BEGIN PGM INCH MM"), "flat, diameter 0.25 mm, length 20 mm");
}

TEST(StatedTools, KlartextCommentsDescribeTheNextOrCalledTool) {
  const auto tools = stated_tools(
      "0 BEGIN PGM T MM\n; FLAT END MILL D=10\n1 TOOL CALL 1 Z S1000\n2 L X+0 Y+0 R0 FMAX M3\n"
      "3 L Z-1 F100\n* - BALL END MILL D=4\n4 TOOL CALL 2 Z\n5 TOOL CALL S3000\n6 L X+9 F100\n"
      "7 TOOL CALL 3 Z ; 2mm drill\n8 CYCL CALL\n; 3mm drill\n9 TOOL CALL Q1 Z\n10 L X+0 F50\n"
      "; END MILL D=8\n11 TOOL CALL 7 Z\n12 L Z+5 FMAX\n; END MILL D=5\n13 L Z-1 F9\n");
  ASSERT_EQ(tools.size(), 4U);
  EXPECT_EQ(tool_text(tools.at(1).shape), "flat, diameter 10 mm, length 50 mm");
  EXPECT_EQ(tool_text(tools.at(2).shape), "ball, diameter 4 mm, length 20 mm");
  EXPECT_EQ(tool_text(tools.at(3).shape),
            "cone end, diameter 2 mm, length 20 mm, tip angle 118 degrees");
  EXPECT_EQ(tool_text(tools.at(7).shape), "flat, diameter 8 mm, length 40 mm");
}

TEST(StatedTools, ToolDefToolsAreFlatUnlessDescribed) {
  const auto tools = stated_tools(
      "0 BEGIN PGM T INCH\n; TOOL 2 BALL END MILL D=0.5\n1 TOOL DEF 1 L+0 R+0.25\n"
      "2 TOOL DEF 2 L+0 R+0.1\n3 TOOL DEF 3 L+Q1 R+Q2\n4 TOOL DEF 4\n5 TOOL DEF 5 L+0 R-1\n"
      "6 TOOL CALL 1 Z\n7 L X+1 F9\n");
  ASSERT_EQ(tools.size(), 2U);
  EXPECT_EQ(std::get<FlatShape>(tools.at(1).shape).diameter_mm, 12.7);
  EXPECT_EQ(tools.at(1).source, "TOOL DEF");
  EXPECT_EQ(tools.at(1).line, 3U);
  EXPECT_TRUE(std::holds_alternative<BallShape>(tools.at(2).shape));
}

TEST(StatedTools, NamedKlartextToolsAreNumberedByRank) {
  const auto tools = stated_tools(
      "BEGIN PGM T MM\n; END MILL D=8\nTOOL CALL \"A B\" Z\nL X+1 F9\nTOOL CALL \"C\" Z\n"
      "L X+2 F9\n; BALL END MILL D=4\nTOOL CALL \"D\" Z\nL X+1 F9\n; 2mm drill\n"
      "TOOL CALL \"A B\" Z\nL X+3 F9\n");
  ASSERT_EQ(tools.size(), 2U);
  EXPECT_EQ(tool_text(tools.at(1).shape), "flat, diameter 8 mm, length 40 mm");
  EXPECT_EQ(tool_text(tools.at(3).shape), "ball, diameter 4 mm, length 20 mm");
}

TEST(StatedStock, IsReadFromComments) {
  const auto size = [](const std::string& text) {
    const auto stated = stated_stock(text, program_unit_mm(text));
    return stated ? stated->size_mm : Vec3{0, 0, 0};
  };
  EXPECT_EQ(size("(STOCK SIZE X100. Y50. Z20.)\n"), (Vec3{100, 50, 20}));
  EXPECT_EQ(size("(stock/block,152.4,76.2, 12.7,0,0,0)\n"), (Vec3{152.4, 76.2, 12.7}));
  EXPECT_EQ(size("( Material Size)\n( X= 300.000 Y= 200.000 Z= 18.000)\n"), (Vec3{300, 200, 18}));
  EXPECT_EQ(size("G20\n(stock 2 x 1 x .5)\n"), (Vec3{50.8, 25.4, 12.7}));
  EXPECT_EQ(size("G20\n(stock 50mm x 20mm x 10mm)\n"), (Vec3{50, 20, 10}));
  EXPECT_EQ(size("G20\n(STOCK 6061AL DX 4.0IN DY 2.0IN DZ 1.0IN)\n"), (Vec3{101.6, 50.8, 25.4}));
  for (const char* none : {"(leave stock 0.5)", "(X1 Y2 Z3)", "(STOCK X1 Y0 Z3)", "STOCK X1 Y1 Z1"})
    EXPECT_FALSE(stated_stock(none, 1)) << none;
}

std::string pycam(const std::string& tool, const std::string& unit = "G21") {
  return unit + "\n;PYCAM_TOOLPATH_SETTINGS: START\n;[Bounds]\n;maxz = 3.0\n;\n;[Tool]\n" + tool +
         ";speed = 1000.0\n;\n;[Process]\n;step_down = 0.1\n;\n;PYCAM_TOOLPATH_SETTINGS: END\n"
         "T3 M6\nG1 X1 F100\n";
}

TEST(StatedTools, SettingsOfPycamAreThoseOfTheNextTool) {
  const auto one = [](const std::string& program) {
    const auto tools = stated_tools(program);
    const auto tool = tools.find(3);
    return tools.size() == 1 && tool != tools.end() ? tool_text(tool->second.shape) : "none";
  };
  EXPECT_EQ(one(pycam(";torus_radius = 0.25\n;shape = CylindricalCutter\n;tool_radius = 1.5\n")),
            "flat, diameter 3 mm, length 20 mm");
  EXPECT_EQ(one(pycam(";shape = SphericalCutter\n;tool_radius = 4\n")),
            "ball, diameter 8 mm, length 40 mm");
  EXPECT_EQ(one(pycam(";torus_radius = 1\n;shape = ToroidalCutter\n;tool_radius = 5\n")),
            "bull nose, diameter 10 mm, length 50 mm, corner radius 1 mm");
  EXPECT_EQ(one(pycam(";shape = CylindricalCutter\n;tool_radius = 0.25\n", "G20")),
            "flat, diameter 12.7 mm, length 63.5 mm");
  EXPECT_EQ(one(pycam(";shape = SpoonCutter\n;tool_radius = 5\n")), "none");
  EXPECT_EQ(one(pycam(";shape = CylindricalCutter\n;tool_radius = -1\n")), "none");
  const auto tools = stated_tools(pycam(";shape = CylindricalCutter\n;tool_radius = 1.5\n"));
  EXPECT_EQ(tools.at(3).origins.shape, Origin::kStated);
  EXPECT_EQ(tools.at(3).origins.diameter, Origin::kDerived);
}

}  // namespace
}  // namespace kerf::stated_tools_test
