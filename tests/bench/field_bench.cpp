// SPDX-License-Identifier: Apache-2.0
// Measures time and memory of the stock: the standard job with one field of rays and with three, a
// block full of grooves, and the same small carving in blocks from 10 mm to 10 m. CPU time of one
// thread.
// Usage: field_bench [pitch_mm=0.1]

#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "tests/support/standard_job.h"

namespace {

using namespace kerf;

double cpu_s() { return double(std::clock()) / CLOCKS_PER_SEC; }

/// Returns the mean CPU time of one call.
template <class Work>
double us_per_call(int calls, Work work) {
  const double start = cpu_s();
  for (int i = 0; i < calls; ++i) work();
  return (cpu_s() - start) / calls * 1e6;
}

void standard_job(Rays rays, bool five_axis, double pitch_mm) {
  SculptureSettings settings = test::standard_settings(pitch_mm, 0.001);
  settings.rays = rays;
  auto s = *Sculpture::create(settings);
  s.apply(DefineTool{1, *make_tool(BallShape{10, 50})}).value();
  const std::vector<ToolPose> path = test::standard_path(five_axis);
  const double start = cpu_s();
  for (std::size_t i = 1; i < path.size(); ++i) {
    s.apply(MoveTool{1, path[i - 1], path[i], 0.01}).value();
  }
  const double us = (cpu_s() - start) / double(path.size() - 1) * 1e6;
  const double snapshot_us = us_per_call(1000, [&] { s.solid(); });
  const double hash_us = us_per_call(5, [&] { s.state_hash(); });
  std::printf(
      "%-9s %d-axis: %8.1f us/move, %5.2f cuts/move, removed %.3f mm3, %6.1f MB, snapshot %.2f us, "
      "hash %.1f ms\n",
      to_string(rays), five_axis ? 5 : 3, us, double(s.sub_motions()) / double(s.motions()),
      s.removed_volume_mm3(), double(s.memory_bytes()) * 1e-6, snapshot_us, hash_us * 1e-3);
  for (const RayAxis axis : {RayAxis::kX, RayAxis::kY, RayAxis::kZ}) {
    if (!s.has_field(axis)) continue;
    const DexelSnapshot field = s.snapshot(axis);
    const double columns = double(field.grid().columns_x) * field.grid().columns_y;
    std::printf("          along %c: removed %.3f mm3, %.1e columns\n", "XYZ"[int(axis)],
                s.stock_volume_mm3() - field.volume_mm3(), columns);
  }
}

/// Cuts 99 parallel grooves with periodic snapshots; rays along Y cross all of them.
void grooves(Rays rays, double pitch_mm) {
  auto s = *Sculpture::create({.stock = BoxStock{{0, 0, 0}, {100, 100, 20}},
                               .rays = rays,
                               .pitch_mm = pitch_mm,
                               .tolerance_mm = 0.001});
  s.apply(DefineTool{1, *make_tool(FlatShape{0.5, 20})}).value();
  const Vec3 up{0, 0, 1};
  const double start = cpu_s();
  for (int k = 0; k < 99; ++k) {
    for (int i = 0; i < 100; ++i) {
      const Vec3 tip{double(k % 2 == 0 ? i : 99 - i), k + 0.51, 15};
      const Vec3 step{k % 2 == 0 ? 1.0 : -1.0, 0, 0};
      s.apply(MoveTool{1, {tip, up}, {tip + step, up}, 0.01, false}).value();
      if (i % 33 == 0) s.solid();
    }
  }
  std::printf("%-9s 99 grooves: %6.1f us/move, removed %.3f mm3, %.1f MB\n", to_string(rays),
              (cpu_s() - start) / 9900 * 1e6, s.removed_volume_mm3(),
              double(s.memory_bytes()) * 1e-6);
}

/// Cuts 100 ticks of 0.1 mm in the middle of the top of a cube, with a snapshot every tenth tick.
void hands_breadth(double side_mm, Rays rays, double pitch_mm) {
  SculptureSettings settings;
  const double half = side_mm / 2;
  settings.stock = BoxStock{{-half, -half, -side_mm}, {half, half, 0}};
  settings.pitch_mm = pitch_mm;
  settings.tolerance_mm = 0.001;
  settings.rays = rays;
  double create_us = -cpu_s() * 1e6;
  auto s = *Sculpture::create(settings);
  create_us += cpu_s() * 1e6;
  const std::size_t untouched = s.memory_bytes();
  s.apply(DefineTool{1, *make_tool(BallShape{4, 30})}).value();
  const Vec3 up{0, 0, 1};
  double snapshot_us = 0;
  const double start = cpu_s();
  for (int i = 0; i < 100; ++i) {
    const double x = -3 + 0.06 * i;
    s.apply(MoveTool{1, {{x, 0, -1}, up}, {{x + 0.06, 0, -1}, up}, 0.001}).value();
    if (i % 10 == 9) snapshot_us += us_per_call(1, [&] { s.solid(); });
  }
  const double us = (cpu_s() - start) * 1e6 - snapshot_us;
  std::printf(
      "%-9s block %7.0f mm: create %6.1f us, untouched %7zu B, %6.1f us/tick, carved "
      "%7.3f MB, hash %.2f ms\n",
      to_string(rays), side_mm, create_us, untouched, us / 100, double(s.memory_bytes()) * 1e-6,
      us_per_call(3, [&] { s.state_hash(); }) * 1e-3);
}

}  // namespace

int main(int argc, char** argv) {
  const double pitch_mm = argc > 1 ? std::atof(argv[1]) : 0.1;
  for (const bool five_axis : {false, true}) {
    standard_job(Rays::kDexel, five_axis, pitch_mm);
    standard_job(Rays::kTriDexel, five_axis, pitch_mm);
  }
  for (const Rays rays : {Rays::kDexel, Rays::kTriDexel}) {
    grooves(rays, pitch_mm);
    for (const double side_mm : {10.0, 100.0, 1000.0, 10000.0}) {
      hands_breadth(side_mm, rays, pitch_mm);
    }
  }
}
