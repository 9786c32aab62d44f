// SPDX-License-Identifier: Apache-2.0
// Measures the cost of sending a new page the whole surface of a block that is carved all over: CPU
// time of the one thread that meshes, best of N, and the bytes, compared with the time that
// predicted_join_s() states. Nothing is meshed yet when the page joins, and it looks at the whole
// block in a picture of 1440 x 900 pixels. Usage: join_bench [N=3]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "kernel/sculpture.h"
#include "server/feed/tile_feed.h"
#include "server/formats/accuracy_choice.h"
#include "tests/bench/cpu_clock.h"

namespace {

using namespace kerf;

constexpr double kHeightMm = 20, kRowMm = 1.5, kStepMm = 1;
/// The page's camera has a field of view of 30 degrees and an allowed error of half a pixel.
constexpr double kDiagonalsAway = 1.9, kErrorRad = 3e-4;

struct Block {
  double side_mm, pitch_mm;
  Rays rays;
};

/// Rows of a ball of 6 mm over the whole block, whose depth varies.
SolidSnapshot carved(const Block& block) {
  Sculpture sculpture =
      *Sculpture::create({.stock = BoxStock{{0, 0, -kHeightMm}, {block.side_mm, block.side_mm, 0}},
                          .rays = block.rays,
                          .pitch_mm = block.pitch_mm});
  if (!sculpture.apply(DefineTool{1, *make_tool(BallShape{6, 30})})) std::exit(1);
  const auto at = [](double x, double y) {
    return ToolPose{{x, y, -3 - std::sin(x / 5) * std::cos(y / 7)}};
  };
  for (double y = 0; y <= block.side_mm; y += kRowMm)
    for (double x = 0; x < block.side_mm; x += kStepMm)
      if (!sculpture.apply(MoveTool{1, at(x, y), at(x + kStepMm, y), 0.1, false})) std::exit(1);
  return sculpture.solid();
}

ViewerLook look_at(const Block& block) {
  const double half = block.side_mm / 2;
  const double away = kDiagonalsAway * std::hypot(block.side_mm, block.side_mm, kHeightMm);
  return {Vec3{half, half, -kHeightMm / 2} + normalized({1, -1, 0.8}) * away, kErrorRad};
}

void measure(const Block& block, int repetitions) {
  const SolidSnapshot solid = carved(block);
  double best = std::numeric_limits<double>::infinity();
  TileFeed::Stats stats;
  for (int n = 0; n < repetitions; ++n) {
    TileFeed feed(solid, 1);
    const double start = test::cpu_seconds();
    const ViewerId page = feed.add_viewer(look_at(block), TileNodes::kRepeated);
    while (const auto frame = feed.next_frame(page)) feed.ack(page, frame->sequence);
    best = std::min(best, test::cpu_seconds() - start);
    stats = feed.stats();
  }
  const double predicted =
      predicted_join_s({block.rays, block.pitch_mm, 0.01, MotionModel::kTight},
                       BoxStock{{0, 0, -kHeightMm}, {block.side_mm, block.side_mm, 0}});
  std::printf("%4.0f mm  %4.2f mm  %-9s  %6llu  %8.3f s  %9.3f s  %5.2f  %8.2f MB  %6.1f us\n",
              block.side_mm, block.pitch_mm, block.rays == Rays::kDexel ? "dexel" : "tri-dexel",
              static_cast<unsigned long long>(stats.tiles_meshed), best, predicted,
              best / predicted, double(stats.bytes_composed) / 1e6,
              1e6 * best / double(stats.tiles_meshed));
}

}  // namespace

int main(int argc, char** argv) {
  const int repetitions = argc > 1 ? std::max(1, std::atoi(argv[1])) : 3;
  std::puts("   side    pitch  rays        tiles    measured  predicted  ratio      bytes  a tile");
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel})
    for (const double side_mm : {40.0, 80.0, 160.0})
      for (const double pitch_mm : {0.5, 0.25, 0.1})
        if (side_mm / pitch_mm <= 1000) measure({side_mm, pitch_mm, rays}, repetitions);
}
