// SPDX-License-Identifier: Apache-2.0
#include <sys/wait.h>

#include "server/carve/tradeoff_plot.h"
#include "server/carve/tradeoff_table.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::tradeoff_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

TradeoffRow row(double us, double error_mm, double pitch_mm = 1) {
  return TradeoffRow{
      .pitch_mm = pitch_mm, .tolerance_mm = 0.01, .us_per_motion = us, .surface_max_mm = error_mm};
}

std::string marks(const std::vector<TradeoffRow>& rows) {
  std::string text;
  for (const TradeoffRow& r : rows) text += r.front ? '*' : '.';
  return text;
}

std::vector<std::vector<std::string>> cells(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> row{""};
    bool quoted = false;
    for (const char c : line) {
      if (c == '"') {
        quoted = !quoted;
      } else if (c == ',' && !quoted) {
        row.emplace_back();
      } else {
        row.back() += c;
      }
    }
    rows.push_back(row);
  }
  return rows;
}

// Whether the XML is well formed: elements are closed in order, and attribute values are quoted and
// contain no <.
bool is_well_formed(const std::string& xml) {
  std::vector<std::string> open;
  std::size_t roots = 0;
  for (std::size_t at = xml.find('<'); at != xml.npos; at = xml.find('<', at)) {
    std::size_t end = at + 1;
    bool quoted = false;
    for (; end < xml.size() && (quoted || xml[end] != '>'); ++end) {
      if (xml[end] == '"') quoted = !quoted;
      if (xml[end] == '<') return false;
    }
    if (end == xml.size()) return false;
    const std::string tag = xml.substr(at + 1, end - at - 1);
    const std::string name = tag.substr(tag[0] == '/' ? 1 : 0, tag.find_first_of(" \n/", 1));
    if (tag[0] == '/') {
      if (open.empty() || open.back() != tag.substr(1)) return false;
      open.pop_back();
    } else if (!tag.ends_with('/')) {
      roots += open.empty() ? 1 : 0;
      open.push_back(name);
    }
    at = end;
  }
  for (std::size_t at = xml.find('&'); at != xml.npos; at = xml.find('&', at + 1))
    if (xml.find(';', at) == xml.npos || xml.find(';', at) > at + 5) return false;
  return open.empty() && roots == 1;
}

TEST(TradeoffTable, FrontContainsUndominatedRows) {
  std::vector<TradeoffRow> rows{row(1, 8), row(2, 9), row(2, 4), row(3, 4), row(9, 1), row(8, 2)};
  mark_front(rows);
  EXPECT_EQ(marks(rows), "*.*.**");
}

TEST(TradeoffTable, FirstOfEqualRowsIsOnTheFront) {
  std::vector<TradeoffRow> rows{row(2, 2), row(2, 2), row(2, 3), row(3, 2)};
  mark_front(rows);
  EXPECT_EQ(marks(rows), "*...");
}

TEST(TradeoffTable, SkippedRowsDoNotAffectTheFront) {
  std::vector<TradeoffRow> rows{row(0, 0), row(5, 5)};
  rows[0].skipped = "too large";
  mark_front(rows);
  mark_cheapest(rows, 10);
  EXPECT_EQ(marks(rows), ".*");
  EXPECT_FALSE(rows[0].cheapest);
  EXPECT_TRUE(rows[1].cheapest);
}

TEST(TradeoffTable, MarksTheCheapestRowThatMeetsTheTarget) {
  std::vector<TradeoffRow> rows{row(1, 8), row(4, 3), row(3, 2.5), row(9, 1)};
  mark_cheapest(rows, 3);
  EXPECT_TRUE(rows[2].cheapest);
  EXPECT_EQ(std::ranges::count(rows, true, &TradeoffRow::cheapest), 1);
  mark_cheapest(rows, 0.5);
  EXPECT_EQ(std::ranges::count(rows, true, &TradeoffRow::cheapest), 0);
}

TEST(TradeoffTable, CsvReadsBackAndListsSkippedRows) {
  std::vector<TradeoffRow> rows{row(1.25, 0.125, 0.5), row(0, 0, 0.1)};
  rows[0].missing_mm = 0.5;
  rows[0].volume_error = 0.25;
  rows[0].bytes = 12;
  rows[1].skipped = "needs 9 MB, too much";
  const auto table = cells(tradeoff_csv(rows));
  ASSERT_EQ(table.size(), 3u);
  for (const auto& line : table) EXPECT_EQ(line.size(), table[0].size());
  EXPECT_EQ(table[0][2], "pitch_mm");
  EXPECT_EQ(table[1][2], "0.5");
  EXPECT_EQ(table[1][4], "0.125");
  EXPECT_EQ(table[1][6], "0.5");
  EXPECT_EQ(table[1][7], "0.25");
  EXPECT_EQ(table[1][8], "");
  EXPECT_EQ(table[1][9], "1.25");
  EXPECT_EQ(table[2].back(), "needs 9 MB, too much");
}

TEST(TradeoffPlot, IsWellFormedForAnyName) {
  std::vector<TradeoffRow> rows{row(1, 8), row(20, 0.3), row(300, 0.001)};
  rows[1].motion = MotionModel::kPaper;
  rows[2].force_error = 0.5;
  const std::string svg = tradeoff_svg(rows, "a <b> & \"c\"", "note");
  EXPECT_TRUE(is_well_formed(svg)) << svg;
  EXPECT_THAT(svg, HasSubstr("a &lt;b&gt; &amp; &quot;c&quot;"));
  EXPECT_THAT(svg, HasSubstr("CPU time per motion"));
  EXPECT_THAT(svg, HasSubstr("class=\"front\""));
  EXPECT_THAT(svg, HasSubstr("dexel, paper"));
  EXPECT_THAT(svg, testing::Not(HasSubstr("nan")));
  EXPECT_TRUE(is_well_formed(tradeoff_svg({}, "empty", "")));
  EXPECT_FALSE(is_well_formed("<svg><g></svg>"));
}

class Tradeoff : public testing::Test {
 protected:
  void SetUp() override {
    write("scene.json",
          R"({"name": "t", "stock": {"shape": "box", "min_mm": [0,0,0], "max_mm": [20,20,10]},
              "accuracy": {"pitch_mm": 1, "tolerance_mm": 0.05},
              "tools": [{"id": 1, "shape": "ball", "diameter_mm": 4, "length_mm": 20}],
              "machine": {"kinematics": "tool-vector"}})");
    write("p.ngc",
          "G21 G90 T1 M6\nG0 X-5 Y10 Z7 I0 J0 K1\nG1 X25 F600\nG0 Z15\nX25 Y5\nG1 Z7 I0 J0.6 "
          "K0.8\nX-5 I0 J0 K1\nM2\n");
  }

  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  std::string content(const std::string& name) const { return test::content_of(folder_ / name); }
  int run(const std::string& arguments) const {
    const std::string command = "cd '" + folder_.path().string() +
                                "' && '" KERF_CARVE "' tradeoff " + arguments +
                                " >out 2>err </dev/null";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  test::TemporaryFolder folder_;
};

const std::string kInput = "--scene scene.json --program p.ngc";

TEST_F(Tradeoff, SweepsAProgramAndWritesTableAndPlot) {
  ASSERT_EQ(run(kInput + " --rays dexel --csv t.csv --svg t.svg --samples 1000 --target 0.8"), 0)
      << content("err");
  const auto table = cells(content("t.csv"));
  ASSERT_EQ(table.size(), 1u + 4 * 2 * 3);
  EXPECT_TRUE(is_well_formed(content("t.svg")));
  int front = 0, cheapest = 0;
  for (std::size_t n = 1; n < table.size(); ++n) {
    const double pitch = std::stod(table[n][2]);
    const double error = std::stod(table[n][4]);
    EXPECT_GT(error, 0) << n;
    // The true surface has a sharp ridge, of which the mesh loses more than a pitch.
    EXPECT_LT(error, 2.5 * pitch) << n;
    EXPECT_LT(std::stod(table[n][5]), error) << n;
    EXPECT_LE(std::stod(table[n][6]), error) << n;
    EXPECT_LT(std::stod(table[n][7]), 0.2) << n;
    EXPECT_FALSE(table[n][8].empty()) << n;
    front += table[n][12] == "1" ? 1 : 0;
    cheapest += table[n][13] == "1" ? 1 : 0;
  }
  EXPECT_GE(front, 4);
  EXPECT_EQ(cheapest, 1);
  EXPECT_THAT(content("out"), HasSubstr("surface max"));
  EXPECT_THAT(content("out"), HasSubstr("\n*"));
  EXPECT_THAT(content("out"), HasSubstr("are compared with pitch"));
}

TEST_F(Tradeoff, CarvesOneConfigurationWithoutRotation) {
  write("p.ngc", "T1 M6\nG0 X-5 Y10 Z7 I0 J0 K1\nG1 X25 F600\nM2\n");
  ASSERT_EQ(run(kInput + " --rays dexel --pitches 1,0.5 --csv t.csv"), 0) << content("err");
  EXPECT_EQ(cells(content("t.csv")).size(), 3u);
  EXPECT_THAT(content("out"), HasSubstr("The program has no rotation"));
}

TEST_F(Tradeoff, FilletsFollowTheToleranceOfEachRow) {
  write("fillet.json",
        R"({"name": "t", "stock": {"shape": "box", "min_mm": [0,0,0], "max_mm": [20,20,10]},
            "accuracy": {"pitch_mm": 0.5, "tolerance_mm": 0.05},
            "tools": [{"id": 1, "shape": "profile", "profile_mm":
              [[0.5,0], {"to": [6,6], "radius": 6, "bulge": "in"}, [6,20]]}],
            "machine": {"kinematics": "xyz"}})");
  write("straight.ngc", "G21 G90 T1 M6\nF600\nG0 X-9 Y10 Z5\nG1 X29\nM2\n");
  ASSERT_EQ(run("--scene fillet.json --program straight.ngc --rays dexel --pitches 0.1"
                " --tolerances 2,0.01 --csv t.csv --samples 1000"),
            0)
      << content("err");
  const auto table = cells(content("t.csv"));
  ASSERT_EQ(table.size(), 3u);
  // The chords are off by 0.2 and 0.001 mm.
  EXPECT_GT(std::stod(table[1][5]), 0.05) << content("t.csv");
  EXPECT_LT(std::stod(table[2][5]), 0.02) << content("t.csv");
  EXPECT_THAT(content("out"), HasSubstr("the tolerance only on fillets"));
}

TEST_F(Tradeoff, RibBetweenTheRaysDoesNotMeetTheTarget) {
  write("rib.json",
        R"({"stock": {"shape": "box", "min_mm": [0,0,0], "max_mm": [20,20,10]},
            "accuracy": {"pitch_mm": 0.3, "tolerance_mm": 0.001},
            "tools": [{"id": 1, "shape": "flat", "diameter_mm": 3, "length_mm": 20}]})");
  write("rib.ngc",
        "G21 G90 T1 M6\nF600\nG0 X-5 Y10.43 Z6\nG1 X25\nG0 Z20\nX-5 Y13.57\nZ6\n"
        "G1 X25\nM2\n");
  ASSERT_EQ(run("--scene rib.json --program rib.ngc --rays dexel --pitches 0.3,0.1 --target 0.3"
                " --samples 1000 --csv t.csv"),
            0)
      << content("err");
  const auto table = cells(content("t.csv"));
  ASSERT_EQ(table.size(), 3u);
  EXPECT_GT(std::stod(table[1][4]), 2);
  EXPECT_EQ(table[1][4], table[1][6]);
  EXPECT_EQ(table[1][13], "0");
  EXPECT_LT(std::stod(table[2][4]), 0.1);
  EXPECT_EQ(table[2][13], "1");
}

TEST_F(Tradeoff, SkipsAndListsConfigurationsBeyondTheBudget) {
  ASSERT_EQ(run(kInput + " --rays dexel --pitches 1,0.001 --motions tight --tolerances 0.05"
                         " --budget-mb 100 --csv t.csv"),
            0)
      << content("err");
  const auto table = cells(content("t.csv"));
  ASSERT_EQ(table.size(), 3u);
  EXPECT_EQ(table[1].back(), "");
  EXPECT_THAT(table[2].back(), HasSubstr("--budget-mb"));
  EXPECT_THAT(content("out"), HasSubstr("skipped"));
}

TEST_F(Tradeoff, ReportsBadInputInOneLine) {
  write("bad.ngc", "G77\n");
  const std::vector<std::pair<std::string, std::string>> cases{
      {"--program p.ngc", "kerf-carve tradeoff: --scene"},
      {"--scene none.json --program p.ngc", "none.json: cannot be read"},
      {"--scene scene.json --program none.ngc", "none.ngc: cannot be read"},
      {"--scene scene.json --program bad.ngc", "bad.ngc:1:"},
      {kInput + " --pitches 1,zero", "kerf-carve tradeoff: --pitches"},
      {kInput + " --pitches 1,-2", "kerf-carve tradeoff: --pitches"},
      {kInput + " --pitches 1e-9", "kerf-carve tradeoff: pitch_mm must be"},
      {kInput + " --motions loose", "kerf-carve tradeoff: --motions"},
      {kInput + " --rays voxel", "kerf-carve tradeoff: --rays"},
      {kInput + " --budget-seconds 0", "kerf-carve tradeoff: --budget-seconds"},
      {kInput + " --wobble", "kerf-carve tradeoff: "},
  };
  for (const auto& [arguments, error] : cases) {
    EXPECT_EQ(run(arguments + " --csv t.csv --svg t.svg"), 2) << arguments;
    EXPECT_THAT(content("err"), StartsWith(error)) << arguments;
    EXPECT_EQ(std::ranges::count(content("err"), '\n'), 1) << arguments;
    EXPECT_FALSE(fs::exists(folder_ / "t.csv")) << arguments;
  }
  EXPECT_EQ(run("--help"), 0);
  EXPECT_THAT(content("out"), HasSubstr("--budget-seconds"));
  EXPECT_EQ(run(kInput + " --rays dexel --pitches 1 --svg none/t.svg --csv t.csv"), 1);
  EXPECT_FALSE(fs::exists(folder_ / "t.csv"));
}

}  // namespace
}  // namespace kerf::tradeoff_test
