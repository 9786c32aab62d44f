// SPDX-License-Identifier: Apache-2.0
// Prints the cost of a restart after an hour of four hands at 1 kHz: size of the files, time until
// the server listens, CPU time until the session is back, without a snapshot, with one, and with
// the one before a damaged one; and how long a snapshot stops the thread of a session.
//
//   restart_bench [--minutes N] [--server PATH]
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "server/formats/pose_grid.h"
#include "server/formats/scene.h"
#include "server/session/replay.h"
#include "server/store/block_snapshot.h"
#include "server/store/journal_writer.h"
#include "tests/bench/cpu_clock.h"
#include "tests/bench/live_client.h"

namespace {

using namespace kerf;
using Clock = std::chrono::steady_clock;

constexpr const char* kScene = R"({"name": "hour",
  "stock": {"shape": "box", "min_mm": [-100, -100, -60], "max_mm": [100, 100, 0]},
  "accuracy": {"rays": "dexel", "pitch_mm": 0.25, "tolerance_mm": 0.01, "motion": "tight"},
  "tools": [{"id": 1, "shape": "ball", "diameter_mm": 10, "length_mm": 60}],
  "machine": {"kinematics": "tool-vector"}})";
constexpr int kHands = 4;

double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Returns the pose at time `t` of a hand that wanders over the block and trembles, deeper with
/// time.
ToolPose hand(int n, double t, double total_s) {
  const double phase = 10.0 * n, depth = 2 + 30 * t / total_s;
  const Vec3 tip{70 * std::sin(0.11 * t + phase) + 20 * std::sin(1.7 * t),
                 70 * std::sin(0.13 * t + 2 * phase) + 20 * std::sin(2.3 * t),
                 -depth - std::sin(0.9 * t + phase) + 0.05 * std::sin(20 * std::numbers::pi * t)};
  return admit_pose({tip, {0, 0, 1}});
}

/// Writes the journal of `seconds` of four hands.
std::uint64_t write_journal(const std::filesystem::path& file, int seconds) {
  const auto scene = parse_scene(kScene, {});
  if (!scene) bench::fail(to_string(scene.error()));
  auto writer = JournalWriter::create(file, {"hour", scene_json(*scene), "", 1, {}}).value();
  for (const auto& [id, tool] : scene->tools) (void)writer.append(0, DefineTool{id, tool.tool});
  std::vector<ToolPose> last(kHands);
  for (int n = 0; n < kHands; ++n) {
    const auto id = static_cast<ParticipantId>(n + 1);
    writer.append(JournalParticipant{id, "hand", "#112233", "agent"});
    last[static_cast<std::size_t>(n)] = hand(n, 0, seconds);
  }
  std::uint64_t sequence = 0;
  for (int ms = 1; ms <= 1000 * seconds; ++ms) {
    for (int n = 0; n < kHands; ++n) {
      ToolPose& at = last[static_cast<std::size_t>(n)];
      const ToolPose to = hand(n, 0.001 * ms, seconds);
      sequence = writer
                     .append(static_cast<ParticipantId>(n + 1), MoveTool{1, at, to, 0.001, true},
                             {0, ms == 1})
                     .value();
      at = to;
    }
    // A commit covers at least 10 ms; more here, to save time.
    if (ms % 200 == 0 && !writer.flush()) bench::fail("cannot write the journal");
  }
  if (!writer.finish()) bench::fail("cannot write the journal");
  return sequence;
}

double mb(const std::filesystem::path& file) {
  return static_cast<double>(std::filesystem::file_size(file)) / 1e6;
}

/// Starts the server on the folder. Prints when it listens, and its CPU time until the session is
/// back. Ends it when `snapshot` exists.
void restart(const char* name, bench::ServerProcess& server,
             const std::filesystem::path& snapshot) {
  const auto start = Clock::now();
  server.start();
  const double listens_ms = ms_since(start);
  while (bench::get(server.port(), "/readyz").find("\"ready\"") == std::string::npos) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  std::printf("%-26s listens after %5.0f ms; back after %6.2f s, %6.2f s of CPU\n", name,
              listens_ms, ms_since(start) / 1000, server.cpu_seconds());
  std::fflush(stdout);
  while (!std::filesystem::exists(snapshot)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  server.kill_hard();
}

/// Prints the longest times that the thread of a session spends on capturing the state of its
/// block, on a motion after that, whose tiles must be copied, and on motions without snapshots.
void measure_stalls(Sculpture& block) {
  double state_us = 0, after_us = 0, plain_us = 0;
  std::vector<SculptureState> kept;
  for (int ms = 1; ms <= 20'000; ++ms) {
    const MoveTool move{1, hand(0, 1000 + 0.001 * (ms - 1), 2000), hand(0, 1000 + 0.001 * ms, 2000),
                        0.001, false};
    const bool takes = ms % 100 == 0;
    if (takes) {
      const double start_us = 1e6 * test::cpu_seconds();
      SculptureState state = block.state();
      state_us = std::max(state_us, 1e6 * test::cpu_seconds() - start_us);
      kept.assign(1, std::move(state));
    }
    const double start_us = 1e6 * test::cpu_seconds();
    if (!block.apply(move)) bench::fail("a motion was rejected");
    double& longest = takes ? after_us : plain_us;
    longest = std::max(longest, 1e6 * test::cpu_seconds() - start_us);
  }
  std::printf(
      "stall of a session: at most %.0f us of CPU for the state of its block; motions at most %.0f "
      "us after it, %.0f us otherwise\n",
      state_us, after_us, plain_us);
}

}  // namespace

int main(int count, char** arguments) {
  std::string program = KERF_SERVER_PROGRAM;
  int minutes = 60;
  for (int i = 1; i + 1 < count; i += 2) {
    const std::string name = arguments[i];
    if (name == "--minutes") minutes = std::max(1, std::atoi(arguments[i + 1]));
    if (name == "--server") program = arguments[i + 1];
  }
  bench::ServerProcess server(program);
  server.kill_hard();
  const auto journal = server.folder() / "hour.kerf";
  const std::uint64_t records = write_journal(journal, 60 * minutes);
  std::printf("%d min of %d hands: %llu records, journal %.1f MB\n", minutes, kHands,
              static_cast<unsigned long long>(records), mb(journal));
  std::fflush(stdout);
  const auto snapshot = snapshot_file(journal);
  restart("without a snapshot", server, snapshot);
  std::printf("snapshot %.1f MB\n", mb(snapshot));
  restart("with a snapshot", server, snapshot);
  std::filesystem::copy_file(snapshot, previous_snapshot_file(journal));
  std::filesystem::resize_file(snapshot, std::filesystem::file_size(snapshot) - 1);
  restart("with a damaged newest one", server, snapshot);
  auto replayed = restore(journal);
  if (!replayed) bench::fail(describe(replayed.error()));
  measure_stalls(replayed->sculpture);
  server.start();  // ends with the program
}
