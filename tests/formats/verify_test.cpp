// SPDX-License-Identifier: Apache-2.0
#include <expat.h>

#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "server/carve/attached_material.h"
#include "server/carve/load_curve.h"
#include "server/carve/markup.h"
#include "tests/formats/verify_fixture.h"
#include "tests/support/carvings.h"

namespace kerf::verify_test {
namespace {

using test::box_stl;
using test::kSlotted;
using test::prism;
using test::slotted;
using test::Verify;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using Json = nlohmann::json;

TEST_F(Verify, AProgramThatMakesThePartPasses) {
  write_program("G0 Z-2\nG1 Y36\n");
  EXPECT_THAT(failed(kSlotted, 0), testing::IsEmpty()) << content("out");
  // 42 mm at 600 mm/min, and rapids of less than a second.
  EXPECT_THAT(content("out"),
              StartsWith("p.ngc makes part.stl within 0.1 mm; cycle time 0:00:04\n"));
}

TEST_F(Verify, ASlotThatIsTooDeepIsAGougeAtItsLine) {
  write_program("G0 Z-2\nG1 Y10\nZ-2.5\nY20\nZ-2\nY36\n");
  const auto checks = failed(kSlotted, 3);
  ASSERT_EQ(checks.size(), 1U) << content("out");
  const Json& gouges = checks.at("gouges");
  EXPECT_EQ(gouges["count"], 1);
  EXPECT_EQ(gouges["worst"][0]["what"], "0.500 mm too deep");
  EXPECT_EQ(gouges["worst"][0]["place"], "p.ngc:6");
  EXPECT_EQ(gouges["worst"][0]["tool"], 1);
  EXPECT_NEAR(gouges["worst"][0]["at_mm"][2], -2.5, 1e-3);
  EXPECT_THAT(content("out"),
              StartsWith("p.ngc does not make part.stl within 0.1 mm: gouges (1);"));
  EXPECT_THAT(content("out"), HasSubstr("0.500 mm too deep, p.ngc:6, tool 1, at X"));
  EXPECT_THAT(failed(kSlotted + "--tolerance 0.6", 0), testing::IsEmpty());
}

// In cm, turned about Z, displaced, and with a missing facet.
TEST_F(Verify, APartIsPlacedAndRepairedOnRequest) {
  write_program("G0 Z-2\nG1 Y36\n");
  std::string part = prism(
      {{-5, -1}, {-1, -1}, {-1, 0}, {-2.6, 0}, {-2.6, -0.2}, {-3.4, -0.2}, {-3.4, 0}, {-5, 0}},
      {{0, 1, 5}, {1, 4, 5}, {1, 2, 4}, {2, 3, 4}, {0, 5, 7}, {5, 6, 7}}, -3, 0);
  const std::size_t facet = part.find("facet normal");
  part.erase(facet, part.find("endfacet\n") + 9 - facet);
  write("part.stl", part);
  const std::string placed = kSlotted +
                             "--reference-unit cm --reference-rotate 0,0,180 "
                             "--reference-translate=-10,0,0 ";
  EXPECT_THAT(failed(placed + "--reference-repair", 0), testing::IsEmpty()) << content("out");
  EXPECT_THAT(content("err"), HasSubstr("part.stl: closed 1 hole"));
  EXPECT_EQ(run(placed), 2);
  EXPECT_THAT(content("err"), HasSubstr("--reference-repair"));
  EXPECT_EQ(run(kSlotted + "--reference-unit foot"), 2);
  EXPECT_EQ(run(kSlotted + "--reference-rotate 0,0,400"), 2);
}

TEST_F(Verify, RemainingRibIsUncutAtTheNearestLine) {
  // Two millimeters of the slot remain between two cuts that end in half discs.
  write_program("G0 Z-2\nG1 Y10\nG0 Z5\nY36\nG0 Z-2\nG1 Y20\n");
  const auto checks = failed(kSlotted, 3);
  ASSERT_EQ(checks.size(), 1U) << content("out");
  const Json& uncut = checks.at("uncut");
  EXPECT_EQ(uncut["count"], 1);
  EXPECT_EQ(uncut["worst"][0]["what"], "2.000 mm left");
  EXPECT_THAT(std::string(uncut["worst"][0]["place"]), testing::AnyOf("p.ngc:5", "p.ngc:9"));
  EXPECT_NEAR(uncut["worst"][0]["at_mm"][1], 15, 5);
  EXPECT_NEAR(uncut["worst"][0]["at_mm"][2], 0, 1e-3);
}

TEST_F(Verify, TheAnswerNamesItsAssumptions) {
  write_program("G0 Z-2\nG1 Y36\n");
  const std::string kDerived =
      "--verify p.ngc --reference part.stl --pitch 0.5 --wall-samples 0 --report r.json ";
  EXPECT_EQ(run(kDerived), 3) << content("err");
  EXPECT_THAT(content("out"), testing::HasSubstr("; assumed: the stock, tool 1; cycle time "));
  EXPECT_EQ(Json::parse(content("r.json"))["verdict"]["assumed"],
            Json::array({"the stock", "tool 1"}));
  EXPECT_EQ(run(kDerived + "--tool 1=8"), 0) << content("out");
  EXPECT_THAT(content("out"), testing::HasSubstr("; assumed: the stock; cycle time "));
}

TEST_F(Verify, AProgramThatCutsNothingIsSaidToCutNothing) {
  write_program("G0 Z90\nG1 Y36\n");
  EXPECT_EQ(run("--verify --program p.ngc --scene scene.json --reference part.stl --report r.json"),
            3)
      << content("err");
  EXPECT_THAT(content("out"),
              StartsWith("p.ngc does not make part.stl within 0.1 mm: nothing was cut, "));
}

TEST_F(Verify, AShankInTheStockIsACollision) {
  write("s.json", R"({"stock": {"shape": "box", "min_mm": [0,0,-10], "max_mm": [40,30,0]},
    "accuracy": {"pitch_mm": 0.5}, "tools": [{"id": 1, "shape": "flat", "diameter_mm": 8,
    "length_mm": 1.5, "shank": {"diameter_mm": 12, "length_mm": 50}}]})");
  write_program("G0 Z-2\nG1 Y36\n");
  const auto checks =
      failed("--verify p.ngc --reference part.stl --scene s.json --wall-samples 0", 3);
  EXPECT_EQ(checks.at("shank or holder in stock")["worst"][0]["place"], "p.ngc:5");
  // The flutes end 0.5 mm below the top.
  EXPECT_THAT(std::string(checks.at("shank or holder in stock")["worst"][0]["what"]),
              testing::MatchesRegex("0\\.(49|50). mm deep"));
}

TEST_F(Verify, DetachedFrameDoesNotCount) {
  write("part.stl", box_stl(10, 30, 10, 30, -10));
  write("p.ngc", "G21 G90 T1 M6\nG0 X7 Y7 Z5\nF600\nG1 Z-10\nX33\nY33\nX7\nY7\nG0 Z5\nM2\n");
  const std::string contour =
      "--verify p.ngc --reference part.stl --tool 1=6 --pitch 0.5 --wall-samples 0 ";
  EXPECT_THAT(failed(contour + "--stock 40,40,10", 0), testing::IsEmpty()) << content("out");
  // The block minus the square around the contour, whose corners are round.
  const Json verdict = Json::parse(content("r.json"))["verdict"];
  EXPECT_NEAR(verdict["cut_loose_mm3"], (1600 - 32 * 32 + (4 - M_PI) * 9) * 10, 100);
  // An assumed stock is the part's bounding box.
  EXPECT_THAT(failed(contour, 0), testing::IsEmpty()) << content("out");
  EXPECT_THAT(content("err"), HasSubstr("X 10 to 30, Y 10 to 30, Z -10 to 0 mm (that of the part"));
  // A floor of 2 mm holds the frame, so the frame counts.
  EXPECT_EQ(failed(contour + "--stock 40,40,12", 3).count("uncut"), 1U);
}

// A plate of 60 x 40 x 9 mm below Z -1, faced in lines that begin and end outside it.
TEST_F(Verify, AssumedStockFailsNoProgram) {
  write("part.stl", prism({{0, -10}, {60, -10}, {60, -1}, {0, -1}}, {{0, 1, 2}, {0, 2, 3}}, 0, 40));
  std::string lines = "G21 G90\nT1 M6 (D=10 flat end mill)\n";
  for (int y = 0; y <= 40; y += 8)
    lines += "G0 Z5\nG0 X-8 Y" + std::to_string(y) + "\nG1 Z-1 F200\nG1 X68 F600\n";
  write("p.ngc", lines + "G0 Z20\nM2\n");
  const std::string plate = "--verify p.ngc --reference part.stl --pitch 0.5 --wall-samples 0 ";
  EXPECT_THAT(failed(plate, 0), testing::IsEmpty()) << content("out");
  EXPECT_THAT(failed(plate + "--stock 60,40,10", 0), testing::IsEmpty()) << content("out");
  EXPECT_EQ(failed(plate + "--stock 60,40,12", 3).count("uncut"), 1U) << "a stated stock counts";
  write("p.ngc", "G21 G90\nT1 M6 (D=10 flat end mill)\nG0 X30 Y20 Z5\nG1 Z-3 F200\nG0 Z20\nM2\n");
  EXPECT_EQ(failed(plate, 3).count("gouges"), 1U) << "cuts into the part still count";
}

TEST_F(Verify, AStockThatIsTooSmallFails) {
  write_program("G0 Z-2\nG1 Y36\n");
  const auto checks =
      failed("--verify p.ngc --reference part.stl --stock 40,30,9 --tool 1=8 --pitch 0.5", 3);
  ASSERT_EQ(checks.size(), 1U) << content("out");
  EXPECT_EQ(checks.at("stock too small")["worst"][0]["what"],
            "1.000 mm of the part outside of the stock");
}

TEST_F(Verify, RejectsInputThatCannotBeJudged) {
  EXPECT_EQ(run("--verify p.ngc"), 2);
  EXPECT_THAT(content("err"), HasSubstr("--verify needs --reference"));
  EXPECT_EQ(run(kSlotted + "--gouge-tolerance 1"), 2);
  EXPECT_THAT(content("err"), HasSubstr("--verify judges by --tolerance"));
  EXPECT_EQ(run("p.ngc --reference part.stl --report r.html"), 2);
  EXPECT_THAT(content("err"), HasSubstr("add --verify"));
  std::string open = slotted();
  open.erase(open.rfind("facet normal"), open.rfind("endsolid") - open.rfind("facet normal"));
  write("part.stl", open);
  write_program("G0 Z-2\nG1 Y36\n");
  EXPECT_EQ(run(kSlotted), 2);
  EXPECT_THAT(content("err"), HasSubstr("part.stl: the mesh is not closed"));
}

/// Elements and text of a document.
struct Document {
  std::map<std::string, int> elements;
  std::string text, attributes;
};

Document parse_xml(const std::string& content) {
  Document document;
  XML_Parser parser = XML_ParserCreate("UTF-8");
  XML_SetUserData(parser, &document);
  XML_SetElementHandler(
      parser,
      [](void* user, const XML_Char* name, const XML_Char** attributes) {
        auto& into = *static_cast<Document*>(user);
        ++into.elements[name];
        for (; *attributes != nullptr; ++attributes)
          into.attributes += std::string(*attributes) + " ";
      },
      [](void*, const XML_Char*) {});
  XML_SetCharacterDataHandler(parser, [](void* user, const XML_Char* text, int length) {
    static_cast<Document*>(user)->text.append(text, static_cast<std::size_t>(length));
  });
  EXPECT_EQ(XML_Parse(parser, content.data(), static_cast<int>(content.size()), 1), XML_STATUS_OK)
      << XML_ErrorString(XML_GetErrorCode(parser)) << " in line "
      << XML_GetCurrentLineNumber(parser);
  XML_ParserFree(parser);
  return document;
}

TEST_F(Verify, PageIsWellFormedAndSelfContained) {
  const std::string name = "a<b>&\"c.ngc";
  write(name,
        "G21 G90 T1 M6\nG0 X20 Y-6 Z5\nF600\nG0 Z-2\n"
        "G1 Y36 Z-2.5 (</code><script>alert[1]</script> &lt; \xE9 \x01 caf\xC3\xA9)\nM2\n");
  EXPECT_EQ(run("--verify '" + name +
                "' --reference part.stl --stock 40,30,10 --tool 1=8 --pitch 0.5 "
                "--report r.HTML"),
            3)
      << content("err");
  const std::string page = content("r.HTML");
  Document document = parse_xml(page);
  EXPECT_EQ(document.elements["script"], 0);
  EXPECT_EQ(document.elements["img"], 3);
  EXPECT_EQ(document.elements["svg"], 1);
  EXPECT_EQ(document.elements["h1"], 1);
  EXPECT_THAT(document.text, HasSubstr("</code><script>alert[1]</script> &lt; \xEF\xBF\xBD"));
  EXPECT_THAT(document.text, HasSubstr("caf\xC3\xA9"));
  EXPECT_THAT(document.text, HasSubstr(name + ":5"));
  EXPECT_THAT(document.text, HasSubstr("mm too deep"));
  EXPECT_THAT(document.text, HasSubstr("--pitch 0.1 finds those of the tolerance"));
  EXPECT_THAT(document.text, HasSubstr("scene: stock: X 0 to 40"));
  EXPECT_THAT(document.text, HasSubstr("state hash"));
  // Only embedded pictures, and the names of XML.
  EXPECT_THAT(document.attributes, HasSubstr("data:image/png;base64,iVBORw0KGgo"));
  EXPECT_THAT(document.attributes, Not(testing::ContainsRegex("(src|href) (https?:|//|/)")));
}

ProgramMotion motion_of(double seconds, std::uint32_t line) {
  return {.tool = 1, .duration_s = seconds, .line = line};
}

TEST(LoadCurve, SpreadsVolumeAndKeepsTheGreatestForce) {
  LoadCurve loads;
  double time_s = 0;
  // 2 mm3 per second, and 5 N in one of a thousand motions.
  for (std::uint32_t n = 1; n <= 1000; ++n) {
    const double seconds = 0.01 * (n % 7 + 1);
    loads.add(motion_of(seconds, n), n == 700 ? 5 : 1, 2 * seconds);
    time_s += seconds;
  }
  EXPECT_NEAR(loads.end_s(), time_s, 1e-9);
  ASSERT_LE(loads.intervals().size(), LoadCurve::kIntervalsMax);
  ASSERT_GT(loads.intervals().size(), LoadCurve::kIntervalsMax / 3);
  double sum = 0;
  for (std::size_t n = 0; n < loads.intervals().size(); ++n) {
    const LoadInterval& interval = loads.intervals()[n];
    sum += interval.removed_mm3;
    const double length_s = std::min(loads.interval_s(), time_s - loads.interval_s() * double(n));
    EXPECT_NEAR(interval.removed_mm3, 2 * length_s, 1e-9) << n;
    EXPECT_EQ(interval.force_n > 1, interval.line == 700U);
  }
  EXPECT_NEAR(sum, 2 * time_s, 1e-9);
}

TEST(LoadCurve, ALongMotionFillsItsTime) {
  LoadCurve loads;
  loads.add(motion_of(1, 1), 0, 0);
  loads.add(motion_of(3, 2), 4, 30);
  const auto& intervals = loads.intervals();
  const auto first = static_cast<std::size_t>(1 / loads.interval_s());
  for (std::size_t n = 0; n < intervals.size(); ++n)
    EXPECT_EQ(intervals[n].force_n, n < first ? 0 : 4) << n;
}

TEST(AttachedMaterial, DetectsLoosePieces) {
  // A groove through the block along Y at X 8 to 12. The part is the corner up to X 6, Y 1.
  auto block = test::make_sculpture(BoxStock{{0, 0, 0}, {20, 10, 5}}, 0.5);
  block.apply(DefineTool{1, make_tool(FlatShape{4, 30}).value()}).value();
  const auto cut = [&](double z) {
    block.apply(MoveTool{1, {{10, -4, z}, {0, 0, 1}}, {{10, 14, z}, {0, 0, 1}}, 1, false}).value();
  };
  auto part = test::make_sculpture(BoxStock{{0, 0, 0}, {20, 10, 5}}, 0.5);
  part.apply(DefineTool{1, make_tool(FlatShape{40, 30}).value()}).value();
  part.apply(MoveTool{1, {{26, -30, 0}, {0, 0, 1}}, {{26, 40, 0}, {0, 0, 1}}, 1, false}).value();
  part.apply(MoveTool{1, {{-30, 21, 0}, {0, 0, 1}}, {{50, 21, 0}, {0, 0, 1}}, 1, false}).value();
  cut(1);
  const AttachedMaterial held(block.snapshot(), part.snapshot());
  EXPECT_EQ(held.loose_mm3(), 0);
  EXPECT_TRUE(held.is_attached(39, 10, 0));
  cut(0);
  const AttachedMaterial loose(block.snapshot(), part.snapshot());
  EXPECT_NEAR(loose.loose_mm3(), 8 * 10 * 5, 1e-6);
  EXPECT_FALSE(loose.is_attached(39, 10, 0));
  EXPECT_TRUE(loose.is_attached(15, 19, 0));
}

TEST(Markup, EscapesEveryByte) {
  std::string all;
  for (int byte = 0; byte < 256; ++byte) all += static_cast<char>(byte);
  all += "\xF0\x9F\x94\xA9 \xED\xA0\x80 \xEF\xBF\xBF \xE2\x82";
  const Document document = parse_xml("<p a=\"" + escaped(all) + "\">" + escaped(all) + "</p>");
  EXPECT_THAT(document.text, HasSubstr("!\"#$%&'"));
  EXPECT_THAT(document.text, HasSubstr(";<=>?@"));
  EXPECT_THAT(document.text, HasSubstr("\xF0\x9F\x94\xA9 \xEF\xBF\xBD"));
}

}  // namespace
}  // namespace kerf::verify_test
