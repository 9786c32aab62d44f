// SPDX-License-Identifier: Apache-2.0
// The program of the manual that reads a .kerf file (web/manual/read_kerf.py).
#include <nlohmann/json.hpp>

#include "server/store/journal_reader.h"
#include "server/store/journal_writer.h"
#include "tests/server/store/random_records.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/test.h"

namespace kerf::read_kerf_test {
namespace {

using nlohmann::json;
using std::filesystem::path;

/// Runs the program; returns its lines. The exit status must be 0.
std::vector<json> program_lines(const path& file) {
  const path program = path(KERF_SOURCE_DIR) / "web/manual/read_kerf.py";
  std::FILE* pipe = popen(("python3 -B " + program.string() + " " + file.string()).c_str(), "r");
  std::string text;
  std::array<char, 4096> part{};
  while (const std::size_t size = std::fread(part.data(), 1, part.size(), pipe)) {
    text.append(part.data(), size);
  }
  EXPECT_EQ(pclose(pipe), 0);
  std::vector<json> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    lines.push_back(json::parse(text.substr(at, end - at)));
    at = end + 1;
  }
  return lines;
}

json json_of(const ToolPose& pose) {
  return {pose.tip_mm.x, pose.tip_mm.y, pose.tip_mm.z, pose.axis.x, pose.axis.y, pose.axis.z};
}

json json_of(const std::vector<ToolPiece>& pieces) {
  json list = json::array();
  for (const ToolPiece& piece : pieces) {
    if (const auto* ball = std::get_if<BallPiece>(&piece)) {
      list.push_back({"ball", ball->center_mm, ball->radius_mm});
    } else if (const auto* arc = std::get_if<ArcPiece>(&piece)) {
      list.push_back(
          {"arc", arc->center_r_mm, arc->center_z_mm, arc->radius_mm, arc->z0_mm, arc->z1_mm});
    } else {
      const auto& frustum = std::get<FrustumPiece>(piece);
      list.push_back({"frustum", frustum.z0_mm, frustum.r0_mm, frustum.z1_mm, frustum.r1_mm});
    }
  }
  return list;
}

json json_of(const JournalRecord& record) {
  json line{{"record", record.sequence}, {"participant", record.participant}};
  if (record.wall_ms != 0) {
    line["ms"] = record.wall_ms;
    line["begins_stroke"] = record.stroke == record.sequence;
  }
  if (const auto* define = std::get_if<DefineTool>(&record.command)) {
    line["tool"] = define->id;
    line["cutting"] = json_of(define->tool.pieces);
    line["other"] = json_of(define->tool.non_cutting);
  } else if (const auto* move = std::get_if<MoveTool>(&record.command)) {
    line["move"] = move->tool;
    line["from"] = json_of(move->from);
    line["to"] = json_of(move->to);
    line["s"] = move->duration_s;
    line["force"] = move->feel;
  } else {
    const auto& change = std::get<StrokeChange>(record.command);
    line[change.undone ? "undo" : "redo"] = change.stroke;
  }
  return line;
}

void expect_same_records(const path& file) {
  std::vector<json> expected;
  auto reader = JournalReader::open(file, RecordOrder::kSequence);
  ASSERT_TRUE(reader);
  for (auto record = reader->next(); record && *record; record = reader->next()) {
    expected.push_back(json_of(**record));
  }
  const auto lines = program_lines(file);
  ASSERT_EQ(lines.size(), expected.size());
  for (std::size_t i = 0; i < lines.size(); ++i) ASSERT_EQ(lines[i], expected[i]);
}

DefineTool tool_of_all_pieces() {
  return {7, make_tool({ArcPiece{2, 1, 1, 0, 1}, FrustumPiece{1, 3, 20, 3}},
                       {FrustumPiece{20, 5, 40, 6}})
                 .value()};
}

TEST(ReadKerf, PrintsTheRecordsOfRandomSessionsToTheBit) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    test::TemporaryFolder folder;
    const path file = folder / "random.kerf";
    ASSERT_TRUE(JournalWriter::create(file, {"random", "{}", "", 1}));
    std::mt19937_64 random(seed);
    {
      auto writer = JournalWriter::open(file, 0);
      ASSERT_TRUE(writer->append(0, tool_of_all_pieces()));
      for (const BatchRecord& record : test::random_records(random, 600)) {
        const auto sequence = writer->append(record.participant, record.command,
                                             {.begins_stroke = record.begins_stroke});
        ASSERT_TRUE(sequence);
        if (random() % 100 == 0) {
          ASSERT_TRUE(writer->append(2, StrokeChange{*sequence, random() % 2 == 0}));
        }
        if (random() % 3 == 0) {
          ASSERT_TRUE(writer->flush());
        }
      }
    }
    expect_same_records(file);
  }
}

TEST(ReadKerf, PrintsAFileOfVersion1) {
  expect_same_records(path(KERF_SOURCE_DIR) / "tests/server/store/journal_v1.kerf");
}

}  // namespace
}  // namespace kerf::read_kerf_test
