// SPDX-License-Identifier: Apache-2.0
// Prints the CPU time of merging two copies of a long journal, after each of which one has been
// carved on, and the bytes that the merged journal takes for a motion that was added.
//
//   merge_bench [COMMON [NEW]]     motions in both copies (1000000), and new ones in each (10000)
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <string>

#include "server/formats/pose_grid.h"
#include "server/formats/scene.h"
#include "server/merge/journal_merge.h"
#include "server/store/journal_file.h"
#include "server/store/journal_reader.h"
#include "server/store/journal_writer.h"
#include "tests/support/temporary_folder.h"

namespace {

using namespace kerf;

constexpr const char* kScene = R"({
  "name": "Merge", "stock": {"shape": "box", "min_mm": [-50, -50, -20], "max_mm": [50, 50, 0]},
  "accuracy": {"rays": "dexel", "pitch_mm": 0.5, "tolerance_mm": 0.01, "motion": "tight"},
  "tools": [{"id": 1, "shape": "ball", "diameter_mm": 4, "length_mm": 60}],
  "machine": {"kinematics": "tool-vector"}})";
constexpr std::uint64_t kStrokeMotions = 200;

/// CPU time of all threads.
double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

[[noreturn]] void fail(const std::string& reason) {
  std::fprintf(stderr, "merge_bench: %s\n", reason.c_str());
  std::exit(1);
}

/// Appends motions of a hand, in strokes.
void carve(JournalWriter& writer, ParticipantId hand, std::uint64_t motions, double phase) {
  const auto pose = [&](std::uint64_t n) {
    const double t = 0.001 * static_cast<double>(n) + phase;
    return admit_pose(
        {{45 * std::sin(1.7 * t), 45 * std::sin(2.3 * t), -2 + std::sin(3.1 * t)}, {0, 0, 1}});
  };
  for (std::uint64_t n = 0; n < motions; ++n) {
    const MoveTool motion{1, pose(n), pose(n + 1), 0.001, false};
    const RecordNote note{.begins_stroke = n % kStrokeMotions == 0};
    while (!writer.append(hand, motion, note)) {
      if (!writer.flush()) fail("the journal cannot be written");
    }
  }
}

void carve_on(const std::filesystem::path& file, ParticipantId hand, std::uint64_t motions) {
  const std::uint64_t last = JournalReader::open(file)->last_sequence();
  auto writer = JournalWriter::open(file, last);
  if (!writer) fail(describe(writer.error()));
  writer->append(JournalParticipant{hand, "hand", "#112233", "agent"});
  carve(*writer, hand, motions, hand);
  if (!writer->finish()) fail("the journal cannot be written");
}

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t common = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 1'000'000;
  const std::uint64_t added = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 10'000;
  const test::TemporaryFolder folder;
  const auto ours = folder / "ours.kerf", theirs = folder / "theirs.kerf";
  {
    auto writer = JournalWriter::create(ours, {"merge", kScene, "", 1, {}});
    if (!writer) fail(describe(writer.error()));
    const Scene scene = parse_scene(kScene, SceneSource{}).value();
    if (!writer->append(0, DefineTool{1, scene.tools.at(1).tool})) fail("no tool");
    writer->append(JournalParticipant{1, "hand", "#112233", "agent"});
    carve(*writer, 1, common, 0);
    if (!writer->finish()) fail("the journal cannot be written");
  }
  if (!copy_journal(ours, theirs)) fail("no copy");
  carve_on(ours, 2, added);
  carve_on(theirs, 3, added);
  const auto before = std::filesystem::file_size(ours);
  const double begin = cpu_seconds();
  const auto merged = append_merged(ours, theirs);
  const double took = cpu_seconds() - begin;
  if (!merged) fail(merged.error().reason);
  const auto after = std::filesystem::file_size(ours);
  std::printf("%llu of %llu motions merged in %.2f s of CPU, %.1f bytes each\n",
              static_cast<unsigned long long>(merged->motions),
              static_cast<unsigned long long>(common + added), took,
              static_cast<double>(after - before) / static_cast<double>(merged->motions));
  return 0;
}
