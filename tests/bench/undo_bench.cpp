// SPDX-License-Identifier: Apache-2.0
// Measures undo in long sessions: undo_bench [motions] [dexel|tri-dexel] [pitch_mm] [threads]
// [undo: nothing after that]. Four hands scribble with balls of 10 mm over a block of 100 x 100 x
// 30 mm, which is carved from the journal. Strokes at random positions in the history are undone
// and redone. Then one viewer visits 60 random records, on one thread, measured from its request to
// the last frame with exact tiles, without a socket.

#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "kernel/cut/workers.h"
#include "kernel/sculpture.h"
#include "server/feed/tile_feed.h"
#include "server/history/block_history.h"
#include "server/history/journal_records.h"
#include "server/store/journal_writer.h"
#include "server/threads/thread_pool.h"
#include "tests/support/temporary_folder.h"

namespace kerf {
namespace {

using Clock = std::chrono::steady_clock;
/// CPU time of all threads.
double process_cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) * 1e-9;
}
double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// A hand that draws smooth strokes of 400 ticks, 0.1 to 0.3 mm each.
class Hand {
 public:
  explicit Hand(unsigned seed) : random_(seed) {}
  MoveTool next(bool& begins) {
    begins = left_ == 0;
    if (begins) {
      at_ = {{uniform(5, 95), uniform(5, 95), uniform(-6, -1)}, {0, 0, 1}};
      heading_ = uniform(0, 6.28);
      left_ = 400;
    }
    --left_;
    heading_ += uniform(-0.1, 0.1);
    ToolPose to = at_;
    const double step = uniform(0.1, 0.3);
    to.tip_mm = to.tip_mm + Vec3{step * std::cos(heading_), step * std::sin(heading_), 0};
    to.tip_mm.x = std::clamp(to.tip_mm.x, 2.0, 98.0);
    to.tip_mm.y = std::clamp(to.tip_mm.y, 2.0, 98.0);
    to.axis = normalized(Vec3{0.2 * std::cos(heading_), 0.2 * std::sin(heading_), 1});
    const auto grid = [](double v, double scale) { return std::round(v * scale) / scale; };
    to.tip_mm = {grid(to.tip_mm.x, 1e6), grid(to.tip_mm.y, 1e6), grid(to.tip_mm.z, 1e6)};
    to.axis = {grid(to.axis.x, 1e9), grid(to.axis.y, 1e9), grid(to.axis.z, 1e9)};
    const MoveTool move{1, at_, to, 0.001, false};
    at_ = to;
    return move;
  }

 private:
  double uniform(double low, double high) {
    return std::uniform_real_distribution(low, high)(random_);
  }
  std::mt19937 random_;
  ToolPose at_;
  double heading_ = 0;
  int left_ = 0;
};

/// Records the motions of the hands. Returns the strokes.
std::vector<StrokeId> record(const std::filesystem::path& file, const Tool& tool,
                             std::int64_t motions) {
  auto writer = JournalWriter::create(file, {"bench", "{}", "", 1, {}}).value();
  writer.append(0, DefineTool{1, tool}).value();
  std::vector<Hand> hands;
  for (unsigned n = 0; n < 4; ++n) hands.emplace_back(n + 1);
  std::vector<StrokeId> strokes;
  for (std::int64_t n = 0; n < motions; ++n) {
    bool begins = false;
    const auto hand = static_cast<std::size_t>(n % 4);
    const MoveTool move = hands[hand].next(begins);
    const auto at = writer.append(static_cast<ParticipantId>(hand + 1), move, {0, begins});
    if (begins) strokes.push_back(at.value());
    if (n % 1000 == 0) (void)writer.flush();
  }
  (void)writer.flush();
  return strokes;
}

struct Times {
  std::vector<double> all_ms, cpu_ms, turn_ms;
};

void print(const char* name, std::vector<double> times) {
  if (times.empty()) return;  // No tile changed.
  std::ranges::sort(times);
  std::printf("  %-34s median %8.1f  p95 %8.1f  worst %8.1f ms\n", name, times[times.size() / 2],
              times[times.size() * 95 / 100], times.back());
}

/// The work of a server when a viewer goes to a record and back to another.
void seek(BlockHistory& history, const SculptureSettings& settings) {
  Sculpture past = Sculpture::create(settings).value();
  TileFeed feed(past.solid(), 0);
  const ViewerId viewer = feed.add_viewer();
  const auto receive = [&] {
    std::size_t bytes = 0;
    while (const auto frame = feed.next_frame(viewer)) {
      bytes += frame->glb->size();
      feed.ack(viewer, frame->sequence);
    }
    return bytes;
  };
  receive();
  std::mt19937 random(9);
  SerialWorkers alone;
  std::vector<double> all_ms, carve_ms, cpu_ms;
  std::size_t bytes = 0;
  for (int n = 0; n < 60; ++n) {
    const MotionSet then{.last = 1 + random() % history.last()};
    const auto begin = Clock::now();
    const double cpu_begin = process_cpu_s();
    const auto tiles = history.carve(history.tiles(), then, alone);
    const ReplacedTiles replaced = past.replace(*tiles);
    carve_ms.push_back(ms_since(begin));
    feed.note_change(past.solid(), replaced.changed_tiles, then.last);
    bytes += receive();
    all_ms.push_back(ms_since(begin));
    cpu_ms.push_back((process_cpu_s() - cpu_begin) * 1000);
  }
  print("a seek of a viewer", all_ms);
  print("  CPU", cpu_ms);
  print("  of that, the block", carve_ms);
  std::printf("  mesh frames of a seek              %.2f MB\n", static_cast<double>(bytes) / 60e6);
}

/// The block after 20 random records.
void look_back(BlockHistory& history, ThreadPool& pool, std::mt19937& random) {
  Times seeks;
  for (int n = 0; n < 20; ++n) {
    const MotionSet then{.last = 1 + random() % history.last()};
    const auto begin = Clock::now();
    const double cpu_begin = process_cpu_s();
    (void)history.carve(history.tiles(), then, pool);
    seeks.all_ms.push_back(ms_since(begin));
    seeks.cpu_ms.push_back((process_cpu_s() - cpu_begin) * 1000);
  }
  print("the block after any record", seeks.all_ms);
  print("  CPU of all threads", seeks.cpu_ms);
  std::printf("  tiles kept                         %.0f MB\n",
              static_cast<double>(history.tile_bytes()) / 1e6);
}

int run(int argc, char** argv) {
  const std::int64_t motions = argc > 1 ? std::atoll(argv[1]) : 100'000;
  SculptureSettings settings;
  settings.stock = BoxStock{{0, 0, -30}, {100, 100, 0}};
  settings.rays = argc > 2 && std::string(argv[2]) == "tri-dexel" ? Rays::kTriDexel : Rays::kDexel;
  settings.pitch_mm = argc > 3 ? std::atof(argv[3]) : 0.25;
  const int threads = argc > 4 ? std::atoi(argv[4]) : 2;
  const Tool tool = make_tool(BallShape{.diameter_mm = 10, .length_mm = 40}).value();
  const test::TemporaryFolder folder;
  Sculpture block = Sculpture::create(settings).value();
  const SolidSnapshot untouched = block.solid();
  const auto strokes = record(folder / "bench.kerf", tool, motions);
  BlockHistory history(journal_records(folder / "bench.kerf"), settings, untouched);
  ThreadPool pool(threads);
  std::printf("%lld motions, %zu strokes, %s, pitch %g mm, %d threads\n",
              static_cast<long long>(motions), strokes.size(), to_string(settings.rays),
              settings.pitch_mm, threads);

  double cpu = process_cpu_s();
  auto start = Clock::now();
  if (auto read = history.catch_up(); !read) return std::puts(read.error().c_str()), 1;
  std::printf("  reading the journal                %.2f s, CPU %.2f us a motion\n",
              ms_since(start) / 1000, (process_cpu_s() - cpu) * 1e6 / static_cast<double>(motions));
  std::printf("  index of motions, %zu tiles        %.2f bytes a motion\n", history.tiles().size(),
              static_cast<double>(history.index_bytes()) / static_cast<double>(motions));
  MotionSet set{.last = history.last()};
  cpu = process_cpu_s();
  start = Clock::now();
  block.replace(*history.carve(history.tiles(), set, pool));
  std::printf("  all tiles for the first time       %.2f s, CPU %.2f us a motion\n",
              ms_since(start) / 1000, (process_cpu_s() - cpu) * 1e6 / static_cast<double>(motions));
  std::mt19937 random(7);
  const auto change = [&](StrokeId stroke, Times& times) {
    if (!set.without.erase(stroke)) set.without.insert(stroke);
    const auto begin = Clock::now();
    const double cpu_begin = process_cpu_s();
    const auto tiles = history.change(block.solid(), *history.reach({stroke}), {stroke}, set, pool);
    for (const TileReplacement& tile : *tiles) {
      const auto turn = Clock::now();
      block.replace({&tile, 1});
      times.turn_ms.push_back(ms_since(turn));
    }
    times.all_ms.push_back(ms_since(begin));
    times.cpu_ms.push_back((process_cpu_s() - cpu_begin) * 1000);
  };
  Times first;
  change(strokes.back(), first);
  std::printf("  the first undo, of the last stroke %.1f ms, CPU %.1f ms\n", first.all_ms[0],
              first.cpu_ms[0]);
  Times later;
  for (int n = 0; n < 40; ++n) change(strokes[random() % strokes.size()], later);
  print("undo and redo of any stroke", later.all_ms);
  print("  CPU of all threads", later.cpu_ms);
  print("  a tile on the session's thread", later.turn_ms);
  if (argc > 5) return 0;
  look_back(history, pool, random);
  seek(history, settings);
  return 0;
}

}  // namespace
}  // namespace kerf

int main(int argc, char** argv) { return kerf::run(argc, argv); }
