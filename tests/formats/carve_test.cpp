// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <csignal>
#include <thread>

#include "server/carve/carve_options.h"
#include "server/formats/model/stl_reader.h"
#include "tests/formats/carve_fixture.h"

namespace kerf::carve_test {
namespace {

namespace fs = std::filesystem;
using test::KerfCarve;
using test::kScene;
using testing::HasSubstr;
using testing::StartsWith;

const std::string kInput = "--scene scene.json --program p.ngc";

TEST_F(KerfCarve, WritesEveryRequestedOutput) {
  const auto json =
      report(kInput +
             " --stl m.stl --glb m.glb --3mf m.3mf --ply m.ply --obj m.obj --ngc o.ngc"
             " --apt o.apt --forces f.csv");
  for (const char* field : {"stock_volume_mm3", "removed_volume_mm3", "motions", "sub_motions",
                            "cut_seconds", "mesh_seconds", "total_seconds", "threads", "triangles",
                            "peak_memory_bytes", "state_hash", "warnings"})
    EXPECT_TRUE(json.contains(field)) << field;
  EXPECT_EQ(json["stock_volume_mm3"], 4000);
  EXPECT_GT(json["removed_volume_mm3"], 160);
  EXPECT_EQ(json["motions"], 5);
  EXPECT_GT(json["peak_memory_bytes"], 1 << 20);
  EXPECT_GT(json["stock_memory_bytes"], 8192);
  EXPECT_LT(json["stock_memory_bytes"], json["peak_memory_bytes"]);
  const std::string stl = content("m.stl");
  const auto triangles = read_stl(std::as_bytes(std::span(stl)));
  ASSERT_TRUE(triangles.has_value());
  EXPECT_EQ(json["triangles"], triangles->size());
  EXPECT_THAT(content("m.glb"), StartsWith("glTF"));
  EXPECT_THAT(content("m.3mf"), StartsWith("PK"));
  EXPECT_THAT(content("m.ply"), StartsWith("ply"));
  EXPECT_THAT(content("m.obj"), StartsWith("# "));
  const std::string forces = content("f.csv");
  EXPECT_EQ(std::count(forces.begin(), forces.end(), '\n'), 6);
  EXPECT_EQ(content("out"), "");
  EXPECT_EQ(files(),
            (std::vector<std::string>{"err", "f.csv", "m.3mf", "m.glb", "m.obj", "m.ply", "m.stl",
                                      "o.apt", "o.ngc", "out", "p.ngc", "r.json", "scene.json"}));
}

TEST_F(KerfCarve, DeviceLimitsAddTheFeltWrenchToTheForces) {
  EXPECT_EQ(run(kInput + " --device-limits 2,50"), 2);
  EXPECT_THAT(content("err"), HasSubstr("--device-limits needs --forces"));
  ASSERT_EQ(run(kInput + " --rate 100 --forces f.csv --device-limits 2,50"), 0) << content("err");
  std::istringstream rows(content("f.csv"));
  std::string row;
  std::getline(rows, row);
  EXPECT_THAT(row, HasSubstr(",imprint_mm3,felt_fx_n,"));
  int reduced = 0;
  while (std::getline(rows, row)) {
    std::vector<double> v;
    std::istringstream fields(row);
    for (std::string field; std::getline(fields, field, ',');) v.push_back(std::stod(field));
    ASSERT_EQ(v.size(), 21U);
    const double computed = std::hypot(v[7], v[8], v[9]), felt = std::hypot(v[15], v[16], v[17]);
    EXPECT_LE(felt, 2 + 1e-6);
    EXPECT_LE(std::hypot(v[18], v[19], v[20]), 50 + 1e-5);
    EXPECT_NEAR(v[19] * computed, v[11] * felt, 1e-5) << "one factor for force and torque";
    reduced += felt < computed ? 1 : 0;
  }
  EXPECT_GT(reduced, 50) << "the slot exceeds the device";
}

TEST_F(KerfCarve, SimplifiesAndMeasuresAgainstAReference) {
  const auto exact = report(kInput + " --stl m.stl --pitch 0.2");
  EXPECT_TRUE(exact["simplified"].is_null());
  EXPECT_TRUE(exact["deviation"].is_null());
  const auto json = report(kInput + " --pitch 0.2 --max-error 0.05 --stl s.stl --3mf s.3mf");
  EXPECT_EQ(json["simplified"]["exact_triangles"], exact["triangles"]);
  EXPECT_EQ(json["simplified"]["crossing_triangles"], 0);
  EXPECT_LT(json["triangles"], exact["triangles"]);
  EXPECT_LE(json["simplified"]["error_mm"], 0.05);
  const auto map =
      report(kInput + " --pitch 0.4 --deviation m.stl --deviation-range 0.25 --ply d.ply");
  EXPECT_LT(map["deviation"]["max_mm"], 0.5);
  EXPECT_LT(map["deviation"]["rms_mm"], 0.1);
  EXPECT_EQ(map["deviation"]["color_range_mm"], 0.25);
  EXPECT_THAT(content("d.ply"), testing::HasSubstr("property float quality"));
  EXPECT_EQ(run(kInput + " --triangles 3 --stl s.stl"), 2);
  EXPECT_THAT(content("err"), testing::HasSubstr("more than the 3 requested"));
  EXPECT_EQ(run(kInput + " --deviation p.ngc"), 2);
  EXPECT_THAT(content("err"),
              testing::HasSubstr("p.ngc: must be a .stl, .ply, .obj, .3mf or .glb file"));
  EXPECT_EQ(run(kInput + " --deviation none.stl"), 2);
}

TEST_F(KerfCarve, WritesTheRequestedEncoding) {
  ASSERT_EQ(run(kInput + " --stl a.stl --stl-encoding ascii --glb a.glb --glb-encoding meshopt"),
            0);
  EXPECT_THAT(content("a.stl"), StartsWith("solid "));
  EXPECT_THAT(content("a.glb"), testing::HasSubstr("EXT_meshopt_compression"));
  EXPECT_EQ(run(kInput + " --glb a.glb --glb-encoding ascii"), 2);
  EXPECT_THAT(content("err"), testing::HasSubstr("--glb-encoding"));
  EXPECT_EQ(run(kInput + " --ply a.ply --ply-encoding ascii"), 2);
}

TEST_F(KerfCarve, ExportedProgramGivesTheSameHash) {
  const std::string hash = report(kInput + " --ngc o.ngc --apt o.apt")["state_hash"];
  EXPECT_EQ(hash.size(), 16u);
  EXPECT_EQ(report("--scene scene.json --program o.ngc")["state_hash"], hash);
  EXPECT_EQ(report("--scene scene.json --program o.apt")["state_hash"], hash);
  EXPECT_NE(report(kInput + " --pitch 0.25")["state_hash"], hash);
}

TEST_F(KerfCarve, SampledProgramIsExportedAsCarved) {
  const auto json = report(kInput + " --rate 20 --apt o.apt");
  EXPECT_GT(json["motions"], 60);
  EXPECT_EQ(report("--scene scene.json --program o.apt")["state_hash"], json["state_hash"]);
}

TEST_F(KerfCarve, OptionsOverrideTheScene) {
  const auto json = report(kInput + " --pitch 1 --tolerance 0.5 --motion paper --law drr");
  EXPECT_EQ(json["pitch_mm"], 1);
  EXPECT_EQ(json["tolerance_mm"], 0.5);
  EXPECT_EQ(json["triangles"], nullptr);
}

TEST_F(KerfCarve, ThreeFieldsGiveTheSameMeshAsOne) {
  const auto one = report(kInput), three = report(kInput + " --rays tri-dexel");
  EXPECT_EQ(one["rays"], "dexel");
  EXPECT_EQ(three["rays"], "tri-dexel");
  EXPECT_NE(three["state_hash"], one["state_hash"]);
  const double removed = one["removed_volume_mm3"];
  EXPECT_NEAR(three["removed_volume_mm3"], removed, 0.05 * removed);
}

TEST_F(KerfCarve, TargetIsResolvedAndReported) {
  std::string scene = kScene;
  scene.replace(scene.find("\"pitch_mm\": 0.5"), 15, "\"target_mm\": 0.4");
  write("target.json", scene);
  const auto json = report("--scene target.json --program p.ngc");
  EXPECT_EQ(json["accuracy"]["target_mm"], 0.4);
  EXPECT_EQ(json["accuracy"]["pitch_mm"], json["pitch_mm"]);
  EXPECT_LE(json["accuracy"]["predicted_error_mm"], 0.4);
  EXPECT_THAT(content("err"), StartsWith("accuracy: dexel, pitch "));
  // Command-line values override the automatic choice.
  const auto fixed = report("--scene target.json --program p.ngc --pitch 0.1");
  EXPECT_EQ(fixed["pitch_mm"], 0.1);
  EXPECT_GT(fixed["tolerance_mm"], json["tolerance_mm"]);
  EXPECT_EQ(run("--scene target.json --program p.ngc --pitch 1"), 2);
  EXPECT_THAT(content("err"), StartsWith("target.json: accuracy.pitch_mm is 1 mm"));
  EXPECT_FALSE(report(kInput)["accuracy"].contains("target_mm"));
}

TEST_F(KerfCarve, BytesDoNotDependOnTheThreadCount) {
  ASSERT_EQ(run(kInput + " --stl a.stl --glb a.glb --ngc a.ngc --threads 1"), 0);
  ASSERT_EQ(run(kInput + " --stl b.stl --glb b.glb --ngc b.ngc --threads 4"), 0);
  EXPECT_TRUE(content("a.stl") == content("b.stl"));
  EXPECT_EQ(content("a.glb"), content("b.glb"));
  EXPECT_EQ(content("a.ngc"), content("b.ngc"));
}

TEST_F(KerfCarve, NeedsNoScene) {
  write("part.nc",
        "G21 G90\n(T1 D=4. CR=0. - flat end mill)\nT1 M6\nG0 X-5 Y10 Z8\nZ-2\nG1 X25 F600\nM2\n");
  ASSERT_EQ(run("part.nc --stl a.stl --write-scene derived.json"), 0) << content("err");
  EXPECT_THAT(content("err"), HasSubstr("scene: tool 1: flat, diameter 4 mm"));
  EXPECT_THAT(content("err"), HasSubstr("scene: stock: X -7 to 27, Y 8 to 12, Z -4 to 0 mm"));
  ASSERT_EQ(run("--scene derived.json --program part.nc --stl b.stl"), 0) << content("err");
  EXPECT_TRUE(content("a.stl") == content("b.stl"));
  ASSERT_EQ(run("--stock 20,20,10 --tool '1=2 mm ball' part.nc"), 0) << content("err");
  EXPECT_THAT(content("err"), HasSubstr("scene: stock: X 0 to 20, Y 0 to 20, Z -10 to 0 mm"));
  EXPECT_THAT(content("err"), HasSubstr("scene: tool 1: ball, diameter 2 mm"));
  EXPECT_EQ(run("part.nc --tool 1=1e9"), 2);
  EXPECT_THAT(content("err"), HasSubstr("must be NUMBER=DIAMETER and a kind"));
  EXPECT_EQ(run("part.nc --tool 99=6"), 2);
  EXPECT_THAT(content("err"), HasSubstr("part.nc: has no tool 99"));
}

TEST_F(KerfCarve, AScenesStockMayBeAModelInAnotherFolder) {
  write("part.nc", "G21\nT1 M6\nG0 X-5 Y10 Z20\nZ8\nG1 X25 F600\nM2\n");
  ASSERT_EQ(run("--scene scene.json --program p.ngc --stl stock.stl"), 0);
  std::filesystem::create_directories(folder_ / "sub");
  ASSERT_EQ(run("part.nc --stock stock.stl --pitch 0.5 --stl a.stl --write-scene sub/s.json"), 0)
      << content("err");
  ASSERT_EQ(run("--scene sub/s.json --program part.nc --stl b.stl"), 0) << content("err");
  EXPECT_TRUE(content("a.stl") == content("b.stl"));
}

TEST_F(KerfCarve, AWrittenSceneNamesTheFilesOfAGivenOne) {
  ASSERT_EQ(run(kInput + " --stl stock.stl"), 0);
  auto scene = nlohmann::json::parse(kScene);
  scene["stock"] = {{"shape", "mesh"}, {"file", "stock.stl"}};
  const auto facet = [](const char* a, const char* b, const char* c) {
    return std::string("facet normal 0 0 0\nouter loop\nvertex ") + a + "\nvertex " + b +
           "\nvertex " + c + "\nendloop\nendfacet\n";
  };
  const char *o = "90 0 0", *x = "95 0 0", *y = "90 5 0", *z = "90 0 5";
  write("wall.stl", "solid w\n" + facet(o, y, x) + facet(o, x, z) + facet(o, z, y) +
                        facet(x, y, z) + "endsolid w\n");
  scene["obstacles"] = {{{"shape", "stl"}, {"file", "wall.stl"}}};
  scene["guides"] = {{{"kind", "path"}, {"file", "p.ngc"}}};
  write("m.json", scene.dump());
  fs::create_directories(folder_ / "sub");
  const std::string rest = " --program p.ngc --wall-samples 0 --stl ";
  ASSERT_EQ(run("--scene m.json --write-scene sub/s.json" + rest + "a.stl"), 0) << content("err");
  ASSERT_EQ(run("--scene sub/s.json --write-scene t.json" + rest + "b.stl"), 0) << content("err");
  EXPECT_TRUE(content("a.stl") == content("b.stl"));
  const auto back = nlohmann::json::parse(content("t.json"));
  EXPECT_EQ(back["stock"]["file"], "stock.stl");
  EXPECT_EQ(back["obstacles"][0]["file"], "wall.stl");
  EXPECT_EQ(back["guides"][0]["file"], "p.ngc");
}

TEST_F(KerfCarve, ReportsLastThatNothingWasCut) {
  write("p.ngc", "T1 M6\nG0 X-5 Y10 Z90\nG1 X25 F100\nM2\n");
  ASSERT_EQ(run(kInput), 0);
  EXPECT_THAT(content("err"), StartsWith("warning: p.ngc: NOTHING WAS CUT"));
}

TEST_F(KerfCarve, WarnsOfRapidsThroughMaterial) {
  write("p.ngc", "T1 M6\nG0 X-5 Y10 Z8\nG0 X25\nM2\n");
  const auto json = report(kInput);
  ASSERT_EQ(json["warnings"].size(), 2u);
  EXPECT_THAT(std::string(json["warnings"][0]), StartsWith("p.ngc: THE PROGRAM CUTS NOTHING"));
  EXPECT_THAT(std::string(json["warnings"][1]),
              StartsWith("p.ngc:3: rapid motion through material"));
  EXPECT_THAT(content("err"), testing::HasSubstr("warning: p.ngc:3:"));
}

TEST_F(KerfCarve, WarnsOncePerShankContact) {
  write("s.json", R"({"stock": {"shape": "box", "min_mm": [0,0,0], "max_mm": [40,20,10]},
    "accuracy": {"pitch_mm": 0.5}, "tools": [{"id": 1, "shape": "flat", "diameter_mm": 2,
    "length_mm": 4, "shank": {"diameter_mm": 10, "length_mm": 50}}]})");
  write("q.ngc", "T1 M6\nF600\nG0 X10 Y10 Z15\nG1 Z7\nG1 Z5\nX12\nZ15\nX30\nZ5.5\nM2\n");
  const auto json = report(  // without the warning about the cusp between the holes
      "--scene s.json --program q.ngc --wall-samples 0");
  ASSERT_EQ(json["warnings"].size(), 2u) << json["warnings"];
  EXPECT_THAT(std::string(json["warnings"][0]),
              StartsWith("q.ngc:5: shank or holder of tool 1 enters the stock, up to 0.9"));
  EXPECT_THAT(std::string(json["warnings"][0]), HasSubstr("until line 6"));
  EXPECT_THAT(std::string(json["warnings"][1]), StartsWith("q.ngc:9:"));
}

TEST_F(KerfCarve, WritesToStandardOutput) {
  ASSERT_EQ(run(kInput + " --report /dev/stdout"), 0);
  EXPECT_THAT(content("out"), HasSubstr("state_hash"));
}

TEST_F(KerfCarve, PrintsHelpVersionAndExplanation) {
  EXPECT_EQ(run("--help"), 0);
  EXPECT_THAT(content("out"), HasSubstr("--scene"));
  EXPECT_EQ(run("--version"), 0);
  EXPECT_THAT(content("out"), StartsWith("kerf-carve "));
  EXPECT_EQ(run("--explain scene.json"), 0);
  EXPECT_THAT(content("out"), HasSubstr("accuracy.pitch_mm"));
}

struct BadInput {
  const char* name;
  const char* file;  ///< a file that is written before the run
  const char* text;
  const char* arguments;
  const char* error;  ///< beginning of the error line
};

class BadInputs : public KerfCarve, public testing::WithParamInterface<BadInput> {};

TEST_P(BadInputs, ExitWithStatusTwoAndLeaveNoFiles) {
  if (GetParam().file[0] != '\0') write(GetParam().file, GetParam().text);
  std::vector<std::string> before = files();
  EXPECT_EQ(run(std::string(GetParam().arguments) +
                " --stl m.stl --glb m.glb --ngc o.ngc --apt o.apt --forces f.csv --report r.json"),
            2);
  const std::string error = content("err");
  EXPECT_THAT(error, StartsWith(GetParam().error));
  EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 1) << error;
  before.insert(before.end(), {"err", "out"});
  std::sort(before.begin(), before.end());
  EXPECT_EQ(files(), before);
}

INSTANTIATE_TEST_SUITE_P(
    KerfCarve, BadInputs,
    testing::Values(
        BadInput{"Code", "p.ngc", "G0 X1\nG77 X5\n", "--scene scene.json --program p.ngc",
                 "p.ngc:2: 'G77' is not a supported code"},
        BadInput{"Apt", "p.apt", "GOFWD/C1\n", "--scene scene.json --program p.apt",
                 "p.apt:1: 'GOFWD' is not"},
        BadInput{"SceneSyntax", "s.json", "{\n]", "--scene s.json --program p.ngc",
                 "s.json:2:1: is not valid JSON"},
        BadInput{"SceneField", "s.json", R"({"stock": {"shape": "ball"}})",
                 "--scene s.json --program p.ngc", "s.json:1:21: stock.shape \"ball\" is not"},
        BadInput{"NoScene", "", "", "--scene none.json --program p.ngc", "none.json: cannot"},
        BadInput{"NoProgram", "", "", "--scene scene.json --program none.ngc", "none.ngc: cannot"},
        BadInput{"Folder", "", "", "--scene scene.json --program .", ".: "},
        BadInput{"Extension", "p.doc", "G0 X1\n", "--scene scene.json --program p.doc", "p.doc: "},
        BadInput{"Usage", "", "", "--scene scene.json", "kerf-carve: a program is required"},
        BadInput{"TwoStocks", "", "", "--scene scene.json --program p.ngc --stock 1,2,3",
                 "kerf-carve: --stock and --tool are"},
        BadInput{"StockSize", "", "", "p.ngc --stock 1,2", "kerf-carve: --stock: must be X,Y,Z"},
        BadInput{"ToolWords", "", "", "p.ngc --tool ball", "kerf-carve: --tool: must be NUMBER"},
        BadInput{"CutsNothing", "p.ngc", "G0 X1\nM2\n", "p.ngc", "p.ngc: cuts nothing"},
        BadInput{"Option", "", "", "--scene scene.json --program p.ngc --wobble 3", "kerf-carve: "},
        BadInput{"Pitch", "", "", "--scene scene.json --program p.ngc --pitch nan", "kerf-carve: "},
        BadInput{"TinyPitch", "", "", "--scene scene.json --program p.ngc --pitch 1e-9",
                 "scene.json: "},
        BadInput{"Rays", "", "", "--scene scene.json --program p.ngc --rays voxel", "kerf-carve: "},
        BadInput{"DeviceLimit", "", "",
                 "--scene scene.json --program p.ngc --forces f.csv --device-limits 6",
                 "kerf-carve: "},
        BadInput{"Rate", "", "", "--scene scene.json --program p.ngc --rate 1e12", "p.ngc: needs"}),
    [](const auto& test) { return test.param.name; });

TEST_F(KerfCarve, InterruptLeavesNoFiles) {
  // Thousands of turns: far more than can be carved before the signal arrives.
  std::string program = "T1 M6\nG0 X15 Y10 Z9\n";
  for (int i = 0; i < 2; ++i) program += "G2 I-5 P1000 F1000\n";
  write("p.ngc", program + "M2\n");
  const std::vector<std::string> before = files();
  const pid_t child = ::fork();
  if (child == 0) {
    if (::chdir(folder_.path().c_str()) != 0) ::_exit(9);
    ::execl(KERF_CARVE, "kerf-carve", "--scene", "scene.json", "--program", "p.ngc", "--tolerance",
            "0.001", "--forces", "f.csv", static_cast<char*>(nullptr));
    ::_exit(9);
  }
  while (files() == before && ::waitpid(child, nullptr, WNOHANG) == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ::kill(child, SIGTERM);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child) << "it ended before it was interrupted";
  EXPECT_EQ(WEXITSTATUS(status), 143);
  EXPECT_EQ(files(), before);
}

TEST_F(KerfCarve, ReportsAnUnwritableFolder) {
  EXPECT_EQ(run(kInput + " --stl m.stl --ngc none/o.ngc"), 1);
  EXPECT_THAT(content("err"), HasSubstr("o.ngc"));
  EXPECT_FALSE(fs::exists(folder_ / "m.stl"));
}

TEST(CarveOptions, AreReadFromTheCommandLine) {
  std::vector<std::string> words{
      "kerf-carve", "--scene", "s",     "--program", "p",     "--rate",         "1000",     "--law",
      "drr",        "--3mf",   "m.3mf", "--glb",     "m.glb", "--glb-encoding", "quantized"};
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  const auto parsed = parse_carve_options(static_cast<int>(argv.size()), argv.data());
  const auto& options = std::get<CarveOptions>(parsed);
  EXPECT_EQ(options.rate_hz, 1000);
  EXPECT_EQ(options.law, "drr");
  ASSERT_EQ(options.models.size(), 2U);
  EXPECT_EQ(options.models[0].format, ModelFormat::kGlb);
  EXPECT_EQ(options.models[0].encoding, ModelEncoding::kQuantized);
  EXPECT_EQ(options.models[1].path, "m.3mf");
}

TEST_F(KerfCarve, AppliesToolTableParametersAndSubroutines) {
  write("scene.json",
        std::string(kScene).replace(std::string(kScene).find("tool-vector"), 11, "xyz"));
  fs::create_directories(folder_ / "subs");
  write("subs/slot.ngc", "o<slot> sub\nG0 X-5 Y#1 Z12\nG1 Z[#2]\nX25\nG0 Z30\no<slot> endsub\n");
  write("t.tbl", "T1 P1 D4 Z50 ; mill\n");
  write("p.var", "5161 0\n5163 120\n5221 3\n5223 20\n");
  write("q.ngc",
        "G21 G90 T1 M6\nG43\nF600\no<slot> call [10] [8]\no<slot> call [4] [7]\nG28\nM2\n");
  const std::string controller = " --tool-table t.tbl --parameters p.var --subroutines subs";
  const auto json = report("--scene scene.json --program q.ngc --stl ref.stl" + controller);
  const auto& simulation = json["simulation"];
  EXPECT_NEAR(json["removed_volume_mm3"], 4 * 20 * 2 + 4 * 20 * 3, 8);
  EXPECT_EQ(simulation["tool_changes"]["count"], 1);
  EXPECT_EQ(simulation["max_engaged_area"]["place"], "subs/slot.ngc:4");
  EXPECT_EQ(simulation["gouges"], nullptr);
  EXPECT_EQ(json["tip_extents"]["max_mm"][2],
            120 - 50 - 20);  // home position, less tool length and G54

  // A program without G43 runs 50 mm deeper, into the stock that the first one left.
  write("bad.ngc", "G21 G90 T1 M6\nF600\no<slot> call [10] [57.5]\nM2\n");
  const auto gouged =
      report("--scene scene.json --program bad.ngc --reference ref.stl" + controller);
  EXPECT_EQ(gouged["simulation"]["gouges"]["worst"][0]["place"], "subs/slot.ngc:4");
  EXPECT_NEAR(gouged["simulation"]["gouges"]["worst"][0]["depth_mm"], 0.5, 0.01);
  EXPECT_EQ(run("--scene scene.json --program q.ngc --tool-table p.var"), 2);
  EXPECT_THAT(content("err"), HasSubstr("p.var:1: '5161'"));
  EXPECT_EQ(run("--scene scene.json --program q.ngc"), 2);
  EXPECT_THAT(content("err"), HasSubstr("q.ngc:4: 'O<SLOT> CALL' calls a subroutine"));
}

}  // namespace
}  // namespace kerf::carve_test
