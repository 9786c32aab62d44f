// SPDX-License-Identifier: Apache-2.0
// Tools described in the comments of programs: the grammar of their words, and the comments of
// Kerf's own exports.
#include "server/formats/derived_scene.h"
#include "server/formats/number_text.h"
#include "server/formats/stated_tools.h"
#include "server/formats/tool_text.h"
#include "server/formats/tool_words.h"
#include "tests/formats/post_fixture.h"
#include "tests/support/test.h"

namespace kerf::tool_comment_test {
namespace {

using test::kPosts;
using test::text_of;

constexpr double kInch = 25.4;

// Returns the tool of words without its length; preceded by "?" if the words are ambiguous.
std::string tool_in(const std::string& words, double unit_mm = 1) {
  const auto tool = tool_of_words(words, unit_mm);
  if (!tool) return "none";
  const std::string text = tool_text(tool->shape);
  const std::size_t length = text.find(", length"), after = text.find(',', length + 1);
  return (tool->doubt.empty() ? "" : "? ") + text.substr(0, length) +
         (after == std::string::npos ? "" : text.substr(after));
}

TEST(ToolWords, NameGaugesOfDrillsAndTaps) {
  EXPECT_EQ(tool_in("#7 DRILL", kInch), "cone end, diameter 5.1054 mm, tip angle 118 degrees");
  EXPECT_EQ(tool_in("#7 HSS DRILL"), "cone end, diameter 5.1054 mm, tip angle 118 degrees");
  EXPECT_EQ(tool_in("NO. 29 DRILL"), "cone end, diameter 3.4544 mm, tip angle 118 degrees");
  EXPECT_EQ(tool_in("#7 (.201) DRILL", kInch),
            "cone end, diameter 5.1054 mm, tip angle 118 degrees");
  EXPECT_EQ(tool_in("F DRILL"), "cone end, diameter 6.5278 mm, tip angle 118 degrees");
  EXPECT_EQ(tool_in("LETTER Q DRILL 135 DEG"),
            "cone end, diameter 8.4328 mm, tip angle 135 degrees");
  EXPECT_EQ(tool_in("#80 DRILL"), "cone end, diameter 0.3429 mm, tip angle 118 degrees");
  EXPECT_EQ(tool_in("#81 DRILL"), "none");
  EXPECT_EQ(tool_in("1/4-20 TAP"), "flat, diameter 6.35 mm");
  EXPECT_EQ(tool_in("M6X1.0 TAP"), "flat, diameter 6 mm");
  EXPECT_EQ(tool_in("NO.7 DRILL", kInch), "cone end, diameter 5.1054 mm, tip angle 118 degrees");
  EXPECT_EQ(tool_in("10-24 TAP", kInch), "flat, diameter 4.826 mm");
  EXPECT_EQ(tool_in("3/8-16 UNC TAP", kInch), "flat, diameter 9.525 mm");
  EXPECT_EQ(tool_in("5MM TAP DRILL"), "cone end, diameter 5 mm, tip angle 118 degrees");
}

TEST(ToolWords, NameCornersAndRadii) {
  const std::string bull = "bull nose, diameter 6 mm, corner radius 1 mm";
  for (const char* text :
       {"6MM R1 BULL NOSE", "6MM BULL NOSE R1", "6MM BULLNOSE 1MM RADIUS", "D6 CR1 BULL", "D=6 R=1",
        "6MM ENDMILL CORNER RADIUS 1", "D6 R1", "END MILL 6MM X R1", "TORUSFRAESER D6 R1",
        "FRAISE TORIQUE D6 R1", "FRESA TORICA DIAMETRO 6 RADIO 1", "6MM 1.0 R ENDMILL"})
    EXPECT_EQ(tool_in(text), bull) << text;
  EXPECT_EQ(tool_in("1/2 EM .03R", kInch), "bull nose, diameter 12.7 mm, corner radius 0.762 mm");
  EXPECT_EQ(tool_in("1/2 X .030R ENDMILL", kInch),
            "bull nose, diameter 12.7 mm, corner radius 0.762 mm");
  EXPECT_EQ(tool_in("BALL R3"), "ball, diameter 6 mm");
  EXPECT_EQ(tool_in("D6 R3"), "ball, diameter 6 mm");
  EXPECT_EQ(tool_in("6MM BULL NOSE"), "? flat, diameter 6 mm") << "its radius is not stated";
  EXPECT_EQ(tool_in("6MM R4 ENDMILL"), "? flat, diameter 6 mm") << "more than half";
  EXPECT_EQ(tool_in("6MM BALL R2"), "? ball, diameter 6 mm");
}

TEST(ToolWords, NameAnglesOfTipsAndSides) {
  const std::string chamfer = "cone end, diameter 6.35 mm, tip angle 90 degrees";
  EXPECT_EQ(tool_in(".25 45 DEG CHAMFER", kInch), chamfer);
  EXPECT_EQ(tool_in("1/4 90 DEGREE CHAMFER MILL"), chamfer);
  EXPECT_EQ(tool_in("D=6.35 CR=0. TAPER=45deg - ZMIN=-1 - chamfer mill"), chamfer);
  EXPECT_EQ(tool_in("1/4 SPOT DRILL"), chamfer);
  EXPECT_EQ(tool_in("6.35MM X 45DEG CHAMFER"), chamfer);
  EXPECT_EQ(tool_in("6.35MM SPOTTING DRILL"), chamfer);
  EXPECT_EQ(tool_in("D6 60 DEG V-BIT"), "cone end, diameter 6 mm, tip angle 60 degrees");
  EXPECT_EQ(tool_in("V60 BIT 6MM"), "cone end, diameter 6 mm, tip angle 60 degrees");
  EXPECT_EQ(tool_in("60\xC2\xB0 V-BIT 6MM"), "cone end, diameter 6 mm, tip angle 60 degrees");
  EXPECT_EQ(tool_in("D4 DRILL POINT ANGLE 140"), "cone end, diameter 4 mm, tip angle 140 degrees");
  EXPECT_EQ(tool_in("3MM TAPERED BALL 5 DEG"),
            "taper with ball tip, diameter 3 mm, half angle 5 degrees");
  EXPECT_EQ(tool_in("10MM END MILL 45 DEG"), "? flat, diameter 10 mm");
  EXPECT_EQ(tool_in("10MM END MILL 45 DEG HELIX"), "flat, diameter 10 mm");
}

TEST(ToolWords, ReadFourLanguages) {
  for (const char* text :
       {"KUGELFRAESER D6", "Kugelfr\xC3\xA4ser D6", "Kugelfr\xE4ser D6", "RADIUSFRAESER R3",
        "FRAISE BOULE D6", "FRAISE HEMISPHERIQUE DIAMETRE 6", "FRESA ESFERICA D6",
        "FRESA PUNTA BOLA \xC3\x98"
        "6",
        "BALL NOSE \xD8"
        "6"})
    EXPECT_EQ(tool_in(text), "ball, diameter 6 mm") << text;
  for (const char* text : {"SCHAFTFRAESER D6 Z4", "VHM SCHAFTFRAESER 6MM 4 SCHNEIDEN",
                           "FRAISE 2 TAILLES D6", "FRAISE CYLINDRIQUE DIAMETRE 6MM 3 DENTS",
                           "FRESA PLANA DIAMETRO 6 4 LABIOS", "PLANFRAESER D=6"})
    EXPECT_EQ(tool_in(text), "flat, diameter 6 mm") << text;
  for (const char* text : {"SPIRALBOHRER D6", "FORET DIAMETRE 6", "BROCA DE 6 MM", "BOHRER 6,0 MM"})
    EXPECT_EQ(tool_in(text), "cone end, diameter 6 mm, tip angle 118 degrees") << text;
  EXPECT_EQ(tool_in("NC-ANBOHRER D6 90 GRAD"), "cone end, diameter 6 mm, tip angle 90 degrees");
  EXPECT_EQ(tool_in("FASENFRAESER D6 45 GRAD"), "cone end, diameter 6 mm, tip angle 90 degrees");
}

TEST(ToolWords, OperationsAreNoTools) {
  for (const char* text :
       {"Engraving 1", "Pocket 12 drill pattern", "DRILL 12 HOLES", "2D CONTOUR 6MM", "FACING 50MM",
        "NOT A 6MM BALL", "6MM OR 8MM ENDMILL", "BOHRBILD 12", "PERCAGE 6MM", "POCHE 12MM"})
    EXPECT_EQ(tool_in(text), "none") << text;
  EXPECT_EQ(tool_in("6MM ROUGHING END MILL"), "flat, diameter 6 mm");
  EXPECT_EQ(tool_in("ENGRAVING BIT 30 DEG 6MM"), "cone end, diameter 6 mm, tip angle 30 degrees");
}

TEST(ToolWords, AreDoubtfulWithAnUnknownWord) {
  EXPECT_EQ(tool_in("AMANA 1/4 UPCUT"), "? flat, diameter 6.35 mm");
  EXPECT_EQ(tool_in("6MM DOVETAIL"), "? flat, diameter 6 mm") << "no shape is stated";
  EXPECT_EQ(tool_in("6MM 8MM ENDMILL"), "none") << "two sizes";
  EXPECT_EQ(tool_in("6MM BALL DRILL"), "none") << "two kinds";
  EXPECT_EQ(tool_in("XYZZY 6"), "none");
  EXPECT_EQ(tool_in(".5 END MILL"), "none") << "probably in inches";
  EXPECT_EQ(tool_in("D=0.5 END MILL"), "flat, diameter 0.5 mm");
  EXPECT_EQ(tool_in("D6 END MILL", kInch), "none") << "probably in mm";
  const auto tool = tool_of_words("AMANA 1/4 UPCUT", 1);
  EXPECT_THAT(tool->doubt, testing::HasSubstr("AMANA"));
  EXPECT_EQ(tool->origins, ToolOrigins{});
}

TEST(ToolWords, ReportTheOriginOfEachField) {
  const auto origins = [](const char* text) { return tool_of_words(text, 1)->origins; };
  EXPECT_EQ(origins("6MM DRILL").angle, Origin::kAssumed);
  EXPECT_EQ(origins("6MM DRILL 135 DEG").angle, Origin::kStated);
  EXPECT_EQ(origins("6MM DRILL").diameter, Origin::kStated);
  EXPECT_EQ(origins("D=6 FLAT").diameter, Origin::kDerived) << "in the unit of the program";
  EXPECT_EQ(origins("D=6 FLAT").shape, Origin::kStated);
  EXPECT_EQ(origins("D=6").shape, Origin::kAssumed);
  EXPECT_EQ(origins("45 DEG CHAMFER MILL 6MM").angle, Origin::kDerived);
}

// A comment made of words with a known meaning, in any order.
struct Made {
  std::string text;
  ToolShape shape;
};

class Maker {
 public:
  explicit Maker(unsigned seed) : random_(seed) {}

  Made make() {
    const int kind = pick(5);
    const bool inch = pick(4) == 0;
    const int steps = 2 + pick(28);
    const double mm = inch ? std::round(25.4e6 * steps / 16) / 1e6 : 0.5 * steps;
    std::vector<std::string> parts{size(mm, inch, steps)};
    const double length = std::max(20.0, 5 * mm);
    Made made;
    if (kind == 0) {
      parts.push_back(of({"END MILL", "FLAT ENDMILL", "SCHAFTFRAESER", "FRAISE CYLINDRIQUE",
                          "FRESA PLANA", "SQUARE END MILL"}));
      made.shape = FlatShape{mm, length};
    } else if (kind == 1) {
      parts.push_back(of({"BALL", "BALL NOSE", "BALL END MILL", "KUGELFRAESER", "FRAISE BOULE",
                          "FRESA ESFERICA"}));
      made.shape = BallShape{mm, length};
    } else if (kind == 2) {
      const double corner = (1 + pick(4)) / 10.0;
      parts.push_back(of({"BULL NOSE", "BULL END MILL", "TORUSFRAESER", "FRESA TORICA"}));
      parts.push_back(of({"R", "CR=", "CORNER RADIUS "}) + decimal_text(corner, 3) + "MM");
      made.shape = BullNoseShape{mm, corner, length};
    } else if (kind == 3) {
      const int angle = of_numbers({118, 135, 140});
      parts.push_back(of({"DRILL", "BOHRER", "FORET", "BROCA"}));
      if (angle != 118 || pick(2) == 0) parts.push_back(std::to_string(angle) + " DEG");
      made.shape = drill_shape(mm, angle);
    } else {
      const int angle = of_numbers({30, 60, 90, 120});
      parts.push_back(of({"V-BIT", "ENGRAVING BIT", "ENGRAVER", "GRAVIERSTICHEL"}));
      parts.push_back(std::to_string(angle) + " DEG");
      made.shape = drill_shape(mm, angle);
    }
    if (pick(3) == 0) parts.push_back(of({"HSS", "VHM", "CARBIDE", "2 FLUTE", "L=75MM", "Z4"}));
    std::ranges::shuffle(parts, random_);
    for (const std::string& part : parts) made.text += (made.text.empty() ? "" : " ") + part;
    return made;
  }
  int pick(int count) { return static_cast<int>(random_() % static_cast<unsigned>(count)); }
  std::string of(std::initializer_list<const char*> texts) {
    return *(texts.begin() + pick(static_cast<int>(texts.size())));
  }

 private:
  int of_numbers(std::initializer_list<int> values) {
    return *(values.begin() + pick(static_cast<int>(values.size())));
  }
  std::string size(double mm, bool inch, int sixteenths) {
    if (inch) return std::to_string(sixteenths) + "/16" + of({"", "\"", " INCH", " IN"});
    const std::string number = decimal_text(mm, 3);
    return of({"D=", "D", "DIA ", "DIA. - ", "DIAMETER: ", ""}) + number + " MM";
  }

  std::mt19937 random_;
};

TEST(ToolWords, NeverContradictAComment) {
  Maker maker(20261);
  int stated = 0;
  constexpr int kComments = 2000;
  for (int n = 0; n < kComments; ++n) {
    const Made made = maker.make();
    const auto tool = tool_of_words(made.text, 1);
    if (!tool || !tool->doubt.empty()) continue;
    ++stated;
    EXPECT_EQ(tool_text(tool->shape), tool_text(made.shape)) << made.text;
  }
  EXPECT_GT(stated, kComments * 9 / 10) << "most are understood";
}

TEST(ToolWords, AreNeverCertainWithAnUnknownWord) {
  Maker maker(7);
  for (int n = 0; n < 500; ++n) {
    const std::string strange = maker.of({"AMANA", "FOO", "XX", "Q", "KLAUS", "@"});
    const std::string text = maker.make().text;
    for (const std::string& words : {strange + " " + text, text + " " + strange}) {
      const auto tool = tool_of_words(words, 1);
      EXPECT_TRUE(!tool || !tool->doubt.empty()) << words;
    }
  }
}

TEST(StatedTools, UseTheUnitStatedInComments) {
  const auto scene =
      test::value_of(derive_scene("p.nc",
                                  "%\nO1\n(T 1 = 1IN FACE MILL)\n(T 2 = .5 END MILL)\nG90 G17\nT2 "
                                  "M06\nG00 X-1. Y0 Z0.5\nG01 Z-.1 F10.\nG01 X1.\nM30\n",
                                  {}, {}));
  EXPECT_EQ(scene.scene.tools.at(2).tool.radius_mm, 6.35);
}

TEST(StatedTools, SelectionLineMayStateOnlyASize) {
  const auto at = [](const std::string& program) {
    const auto tools = stated_tools(program, 1);
    return tools.contains(1) ? tool_text(tools.at(1).shape) : "none";
  };
  EXPECT_EQ(at("T1M6(D26)\nG1 X1\n"), "flat, diameter 26 mm, length 130 mm");
  EXPECT_EQ(at("T1 M6 (6MM)\nG1 X1\n"), "flat, diameter 6 mm, length 30 mm");
  EXPECT_EQ(at("(1 = End Mill {6 mm})\nT1 M6\nG1 X1\n"), "flat, diameter 6 mm, length 30 mm");
  EXPECT_EQ(at("T1 M6\nG41 D1 (OFFSET 5MM)\nG1 X1\n"), "none");
  EXPECT_EQ(at("(Pocket 5mm)\nT1 M6\n(Face 3)\n(CLEARANCE 5MM)\nG1 X1\n"), "none");
}

TEST(StatedTools, CertainCommentReplacesADoubtfulOne) {
  const auto tools = stated_tools("(T1 8MM FOO ENDMILL)\n(T1 6MM ENDMILL)\nT1 M6\nG1 X1\n", 1);
  EXPECT_EQ(tool_text(tools.at(1).shape), "flat, diameter 6 mm, length 30 mm");
  EXPECT_EQ(tools.at(1).doubt, "");
}

std::vector<ToolShape> every_shape() {
  return {BallShape{6.35, 30},
          FlatShape{0.1, 42},
          BullNoseShape{10, 1.25, 30},
          TaperShape{3, 7.125, 40, TaperTip::kFlat},
          TaperShape{3, 5, 40, TaperTip::kBall},
          ConeEndShape{6, 118, 30},
          ConeEndShape{12, 60.5, 40},
          AptShape{10, 1, 4, 1, 0, 0, 30},
          AptShape{12, 21, -15, 10, 0, 0, 20},
          ProfileShape{{ProfilePoint{0, 0}, ProfileCenteredArc{{3, 9}, {0, 5}, ArcBulge::kOut},
                        ProfilePoint{3, 30}}},
          ProfileShape{{ProfilePoint{2, 0}, ProfilePoint{5, 4}, ProfilePoint{1.5, 4},
                        ProfileArc{{3, 8}, 20, ArcBulge::kIn}, ProfilePoint{3, 31.0625}},
                       0.001}};
}

Scene with_tools(const std::vector<ToolShape>& shapes) {
  Scene scene{.name = "own", .settings = {.stock = BoxStock{{-30, -30, -20}, {30, 30, 0}}}};
  ToolId id = 0;
  for (const ToolShape& shape : shapes)
    scene.tools[++id] = {.shape = shape, .body = {}, .tool = *make_tool(shape)};
  return scene;
}

Program cut_with_each(const Scene& scene) {
  Program program;
  for (const auto& [id, tool] : scene.tools) {
    const ToolPose above{{-20, 0, 5}, {0, 0, 1}}, in{{-20, 0, -2}, {0, 0, 1}},
        end{{20, 0, -2}, {0, 0, 1}};
    program.motions.push_back({.tool = id, .from = above, .to = in, .duration_s = 1});
    program.motions.push_back({.tool = id, .from = in, .to = end, .duration_s = 4});
  }
  return program;
}

void expect_same_tools(const Scene& scene, const std::string& name, const std::string& text) {
  const auto derived = derive_scene(name, text, {}, {});
  ASSERT_TRUE(derived) << derived.error() << "\n" << text;
  for (const auto& [id, tool] : scene.tools) {
    ASSERT_TRUE(derived->scene.tools.contains(id)) << text;
    EXPECT_EQ(tool_comments(id, derived->scene.tools.at(id).shape), tool_comments(id, tool.shape))
        << text;
  }
  for (const FieldOrigin& origin : derived->origins)
    EXPECT_TRUE(origin.tool == 0 || origin.origin == Origin::kStated) << origin.field;
}

TEST(ExportedTools, RoundTripThroughEveryPostprocessor) {
  const Scene scene = with_tools(every_shape());
  const Program program = cut_with_each(scene);
  for (const Post post : kPosts) {
    SCOPED_TRACE(std::string(rules_of(post).name));
    expect_same_tools(scene, post == Post::kHeidenhain ? "p.h" : "p.nc",
                      text_of(program, scene, post));
  }
  std::ostringstream apt;
  const auto writer = make_program_writer({.format = ProgramFormat::kApt}, scene, apt);
  ASSERT_TRUE(write_program(program, **writer));
  expect_same_tools(scene, "p.apt", apt.str());
}

TEST(ExportedTools, ToolsWithManyPointsNeedSeveralComments) {
  ProfileShape saw{{ProfilePoint{0, 0}}};
  for (int tooth = 1; tooth <= 40; ++tooth)
    saw.steps.push_back(ProfilePoint{2.123456 + tooth % 3, tooth * 0.987654});
  const Scene scene = with_tools({saw});
  EXPECT_GT(tool_comments(1, saw).size(), 3U);
  for (const Post post : {Post::kLinuxcnc, Post::kFanuc, Post::kHeidenhain})
    expect_same_tools(scene, post == Post::kHeidenhain ? "p.h" : "p.nc",
                      text_of(cut_with_each(scene), scene, post));
}

TEST(DerivedScene, ReportsTheOriginOfEachField) {
  const auto scene =
      test::value_of(derive_scene("p.nc",
                                  "G21\n(T1 6MM DRILL)\n(T2 AMANA 1/4 UPCUT)\n(STOCK X40 Y40 Z10)\n"
                                  "T1 M6\nG0 X0 Y0 Z5\nG1 Z-1 F9\nX9\nT2 M6\nX0\nT3 M6\nX9\nM2\n",
                                  {}, {}));
  const auto origin = [&](ToolId tool, const std::string& field) {
    for (const FieldOrigin& one : scene.origins)
      if (one.tool == tool && one.field == field)
        return std::string(to_string(one.origin)) + " " + one.source;
    return std::string("none");
  };
  EXPECT_EQ(origin(1, "diameter_mm"), "stated comment in line 2");
  EXPECT_EQ(origin(1, "tip_angle_deg"), "assumed ");
  EXPECT_EQ(origin(2, "diameter_mm"), "assumed ");
  EXPECT_EQ(origin(3, "shape"), "assumed ");
  EXPECT_EQ(origin(0, "stock.size"), "stated comment in line 4");
  EXPECT_EQ(origin(0, "machine.kinematics").substr(0, 7), "derived");
  EXPECT_THAT(scene.notes, testing::Contains(testing::HasSubstr("\"AMANA\" is not understood")));
}

TEST(StatedStock, AptStockIsThatOfItsInsert) {
  const auto stated =
      stated_tools("PARTNO/1\nUNITS/INCHES\n$$-> CUTTER / 0.500000\nLOADTL/1\nGOTO/0,0,0\n", kInch);
  ASSERT_TRUE(stated.contains(1)) << "the cutter of Creo";
  EXPECT_EQ(std::get<FlatShape>(stated.at(1).shape).diameter_mm, 12.7);
  const auto scene = test::value_of(derive_scene(
      "p.apt",
      "UNIT/MM\nCUTTER/6.,0,3.,0,0,0,50.\nLOAD/TOOL,1\nINSERT/Stock Size X100. Y60. Z12.\n"
      "RAPID/\nGOTO/20,20,25.\nFEDRAT/300.,MMPM\nGOTO/20,20,-3.\nGOTO/40,20,-3.\nFINI\n",
      {}, {}));
  const BoxStock box = stock_bounds(scene.scene.settings.stock);
  EXPECT_EQ(box.min_mm, (Vec3{0, 0, -12}));
  EXPECT_EQ(box.max_mm, (Vec3{100, 60, 0}));
}

}  // namespace
}  // namespace kerf::tool_comment_test
