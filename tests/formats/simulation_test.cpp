// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "server/carve/program_cutter.h"
#include "server/carve/simulation_json.h"
#include "tests/formats/scene_fixture.h"
#include "tests/support/test.h"

namespace kerf::simulation_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Json = nlohmann::json;

// A block of 40 x 40 x 10 mm, its top at 0, and flat tools of 6 mm (1) and 4 mm (2), the second
// with a wide holder above its 5 mm.
Scene block(const std::string& more = "") {
  const std::string text =
      R"({"name": "s", "stock": {"shape": "box", "min_mm": [0,0,-10], "max_mm": [40,40,0]},
          "accuracy": {"pitch_mm": 0.25, "tolerance_mm": 0.01},
          "force": {"law": "specific_energy", "specific_force_n_per_mm2": 2},
          "tools": [{"id": 1, "shape": "flat", "diameter_mm": 6, "length_mm": 30},
                    {"id": 2, "shape": "flat", "diameter_mm": 4, "length_mm": 5,
                     "holder": [{"diameter_mm": 20, "length_mm": 20}]}])" +
      more + "}";
  auto scene = parse_scene(text, {});
  EXPECT_TRUE(scene.has_value()) << to_string(scene.error());
  return scene.value();
}

struct Simulated {
  Program program;
  Json report;
  std::vector<std::string> warnings;
};

IndexedMesh box_mesh(Vec3 low, Vec3 high);

Simulated run(const Scene& scene, const std::string& text, const IndexedMesh* reference = nullptr,
              double gouge_tolerance_mm = 0.02) {
  Simulated run{.program = test::gcode(scene, text)};
  auto sculpture = Sculpture::create(scene.settings).value();
  for (const auto& [id, tool] : scene.tools)
    EXPECT_TRUE(sculpture.apply(DefineTool{id, tool.tool}).has_value());
  Simulation simulation(scene, run.program, true);
  const DexelSnapshot before = sculpture.snapshot();
  SerialWorkers alone;
  ProgramCutter cutter(scene, run.program, sculpture, alone, false);
  for (std::span<const ProgramMotion> left = run.program.motions; !left.empty();) {
    const std::vector<ProgramCut> cuts = cutter.cut(left, {}).value();
    for (const ProgramCut& cut : cuts) {
      simulation.follow(left.front(), cut.result, cut.depth_mm);
      left = left.subspan(1);
    }
  }
  PartFit fit;
  if (reference != nullptr)
    fit = fit_part(before, sculpture.snapshot(), *reference, scene, run.program,
                   {gouge_tolerance_mm, false}, {})
              .value();
  warn_of_simulation(simulation, fit, run.warnings);
  run.report = Json::parse(simulation_json(simulation, 8, fit));
  return run;
}

TEST(Simulation, SeparatesFeedRapidAndDwellTimes) {
  const Simulated r =
      run(block(),
          "T1 M6\nG0 X-5 Y20 Z5\nG0 Z-2\nG1 X45 F600\nG4 P1.5\nG0 Z5\nT2 M6\nG1 X35 F300\nM2\n");
  EXPECT_NEAR(r.report["feed_seconds"], 5 + 2, 1e-9);
  EXPECT_NEAR(r.report["dwell_seconds"], 1.5, 1e-9);
  EXPECT_NEAR(r.report["rapid_seconds"], 14 * 60 / 10000.0, 1e-9);
  EXPECT_EQ(r.report["tool_changes"]["count"], 2);
  EXPECT_EQ(r.report["tool_changes"]["seconds"], 16);
  EXPECT_EQ(r.report["tool_changes"]["first"][1]["place"], "p.ngc:7");
  EXPECT_NEAR(r.report["cycle_seconds"], 7 + 1.5 + 0.084 + 16, 1e-9);
  EXPECT_NEAR(r.report["feed_length_mm"], 60, 1e-9);
}

TEST(Simulation, CountsFeedsWithoutRemovalAsAir) {
  const Simulated r =
      run(block(), "T1 M6\nG0 X-5 Y20 Z-2\nG1 X20 F600\nX45\nG1 Z5 F1200\nX-5\nM2\n");
  EXPECT_NEAR(r.report["air_cutting"]["length_mm"], 57, 1e-9);
  EXPECT_NEAR(r.report["air_cutting"]["seconds"], 2.85, 1e-9);
  EXPECT_NEAR(r.report["air_cutting"]["share_of_feed_length"], 57.0 / 107, 1e-9);
  EXPECT_NEAR(r.report["air_cutting"]["share_of_feed_time"], 2.85 / (5 + 2.85), 1e-9);
  EXPECT_EQ(r.report["tools"][0]["air_length_mm"], r.report["air_cutting"]["length_mm"]);
}

TEST(Simulation, MaximaOccurAtTheDeepestCut) {
  const Simulated r =
      run(block(), "T1 M6\nG0 X-5 Y20 Z-1\nG1 X45 F600\nG0 Z5\nX-5 Y10\nZ-3\nG1 X45\nM2\n");
  // A slot of 6 x 3 mm; 40 of 50 mm of the motion are in the block.
  EXPECT_NEAR(r.report["max_engaged_area"]["mm2"], 18 * 40 / 50.0, 0.2);
  EXPECT_EQ(r.report["max_engaged_area"]["place"], "p.ngc:7");
  EXPECT_NEAR(r.report["max_force"]["n"], 2 * 18 * 40 / 50.0, 0.4);
  EXPECT_NEAR(r.report["max_removal_rate"]["mm3_per_s"], 18 * 40 / 5.0, 2);
  EXPECT_NEAR(r.report["tools"][0]["removed_mm3"], 6 * 1 * 40 + 6 * 3 * 40, 8);
}

TEST(Simulation, CollisionsNameLinesAndPartner) {
  const Simulated r =
      run(block(R"(, "obstacles": [{"shape": "box", "min_mm": [50,0,-10], "max_mm": [60,40,20]}])"),
          "T2 M6\nG0 X20 Y20 Z1\nG1 Z-4 F100\nZ-8\nX22\nG0 Z5\nX70\nM2\n");
  ASSERT_EQ(r.report["collisions"].size(), 2u);
  const Json& stock = r.report["collisions"][0];
  EXPECT_EQ(stock["with"], "stock");
  EXPECT_EQ(stock["from"], "p.ngc:4");
  EXPECT_NEAR(stock["depth_mm"], 3, 0.3);
  const Json& obstacle = r.report["collisions"][1];
  EXPECT_EQ(obstacle["with"], "obstacle");
  EXPECT_EQ(obstacle["from"], "p.ngc:7");
  EXPECT_TRUE(obstacle["in_rapid"]);
  // The flutes are 5 mm long: stock above them is cut during the retract.
  EXPECT_THAT(r.warnings, ElementsAre(HasSubstr("p.ngc:6: rapid motion through material"),
                                      HasSubstr("p.ngc:4: shank or holder"),
                                      HasSubstr("p.ngc:7: tool 2 touches an obstacle")));
}

TEST(Simulation, ReportsToolsThatStartInsideStock) {
  // Tool 2 cuts a slot 4 mm wide and 2 mm deep; tool 1, 6 mm wide, is chosen inside it.
  const Simulated r = run(block(), "T2 M6\nG0 X-5 Y20 Z-2\nG1 X20 F600\nT1 M6\nX30\nM2\n");
  ASSERT_EQ(r.report["starts_inside_stock"].size(), 1u);
  EXPECT_EQ(r.report["starts_inside_stock"][0]["place"], "p.ngc:5");
  EXPECT_EQ(r.report["starts_inside_stock"][0]["tool"], 1);
  const Json& large = r.report["tools"][0];
  const Json& small = r.report["tools"][1];
  EXPECT_EQ(large["imprint_mm3"], r.report["starts_inside_stock"][0]["imprint_mm3"]);
  EXPECT_EQ(small["imprint_mm3"], 0);
  // The disc of 6 mm without the slot: a band behind its middle, a half disc of 4 mm ahead of it.
  const double band = 2 * std::sqrt(5.0) + 9 * std::asin(2.0 / 3);
  EXPECT_NEAR(large["imprint_mm3"], 2 * (9 * M_PI - band - 2 * M_PI), 1);
  // Each mm of path cuts 6 x 2 mm²: the imprint adds no load.
  EXPECT_NEAR(large["max_engaged_area"]["mm2"], 12, 0.3);
  EXPECT_THAT(r.warnings, ElementsAre(HasSubstr("p.ngc:5: the tool starts inside the stock")));
}

TEST(Simulation, ReportsRapidsThroughMaterialOncePerLine) {
  const Simulated r = run(block(), "T1 M6\nG0 X-5 Y20 Z-2\nG0 X20\nX45\nM2\n");
  ASSERT_EQ(r.report["rapids_through_stock"].size(), 2u);
  EXPECT_EQ(r.report["rapids_through_stock"][0]["place"], "p.ngc:3");
  EXPECT_NEAR(double(r.report["rapids_through_stock"][0]["depth_mm"]), 2, 0.025) << "0.1 pitches";
  EXPECT_THAT(r.warnings, ElementsAre(HasSubstr("p.ngc:3: rapid"), HasSubstr("p.ngc:4: rapid")));
}

IndexedMesh box_mesh(Vec3 low, Vec3 high) {
  IndexedMesh mesh;
  for (int n = 0; n < 8; ++n)
    mesh.positions_mm.push_back({static_cast<float>((n & 1) != 0 ? high.x : low.x),
                                 static_cast<float>((n & 2) != 0 ? high.y : low.y),
                                 static_cast<float>((n & 4) != 0 ? high.z : low.z)});
  const std::uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                     {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& q : quads) {
    mesh.triangles.push_back({q[0], q[1], q[2]});
    mesh.triangles.push_back({q[0], q[2], q[3]});
  }
  return mesh;
}

const std::string kSlot = "T1 M6\nG0 X-5 Y20 Z-2\nG1 X18 F600\n";

TEST(Gouges, AreReportedWithDepthPositionAndLine) {
  // The part is everything below -2.
  const IndexedMesh reference = box_mesh({0, 0, -10}, {40, 40, -2});
  const Simulated r = run(block(), kSlot + "Z-2.75\nX20\nZ-2\nX45\nM2\n", &reference);
  ASSERT_EQ(r.report["gouges"]["count"], 1);
  const Json& gouge = r.report["gouges"]["worst"][0];
  EXPECT_NEAR(gouge["depth_mm"], 0.75, 1e-3);
  EXPECT_EQ(gouge["place"], "p.ngc:4");
  EXPECT_EQ(gouge["tool"], 1);
  EXPECT_NEAR(gouge["deepest_mm"][2], -2.75, 1e-3);
  // A slot of 6 mm that is 2 mm long: a circle and a square.
  const double area = 9 * 3.14159 + 12;
  EXPECT_NEAR(gouge["area_mm2"], area, 1.5);
  EXPECT_NEAR(gouge["volume_mm3"], area * 0.75, 1.5);
  EXPECT_THAT(r.warnings, ElementsAre(HasSubstr("p.ngc:4: gouge into the reference")));
}

TEST(Gouges, CutOnTheReferenceSurfaceIsNoGouge) {
  const IndexedMesh reference = box_mesh({0, 0, -10}, {40, 40, -2});
  const Simulated r = run(block(), kSlot + "X45\nM2\n", &reference);
  EXPECT_EQ(r.report["gouges"]["count"], 0);
  EXPECT_THAT(r.warnings, IsEmpty());
}

TEST(Gouges, CutsWithinTheToleranceAreNoGouges) {
  const IndexedMesh reference = box_mesh({0, 0, -10}, {40, 40, -2});
  EXPECT_EQ(run(block(), kSlot + "Z-2.04\nX30\nM2\n", &reference, 0.05).report["gouges"]["count"],
            0);
  EXPECT_EQ(run(block(), kSlot + "Z-2.04\nX30\nM2\n", &reference, 0.03).report["gouges"]["count"],
            1);
}

TEST(Gouges, FindsAWallThatWasRemovedEntirely) {
  // A wall of 2 mm across the slot, which removes all of it there.
  const IndexedMesh reference = box_mesh({29, 0, -10}, {31, 40, 0});
  const Simulated r = run(block(), kSlot + "X45\nM2\n", &reference);
  ASSERT_EQ(r.report["gouges"]["count"], 1);
  const Json& gouge = r.report["gouges"]["worst"][0];
  EXPECT_NEAR(gouge["depth_mm"], 1, 0.2);
  EXPECT_EQ(gouge["place"], "p.ngc:4");
  EXPECT_NEAR(gouge["volume_mm3"], 2 * 6 * 2, 2.5);
}

TEST(Gouges, SeparateRegionsAreSeparateGouges) {
  const IndexedMesh reference = box_mesh({0, 0, -10}, {40, 40, -2});
  const Simulated r =
      run(block(), "T2 M6\nG0 X10 Y10 Z1\nG1 Z-3 F100\nZ1\nG0 X30\nG1 Z-2.5\nZ1\nM2\n", &reference);
  ASSERT_EQ(r.report["gouges"]["count"], 2);
  EXPECT_EQ(r.report["gouges"]["worst"][0]["place"], "p.ngc:3");
  EXPECT_EQ(r.report["gouges"]["worst"][1]["place"], "p.ngc:6");
}

}  // namespace
}  // namespace kerf::simulation_test
