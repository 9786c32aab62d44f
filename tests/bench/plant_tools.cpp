// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/plant_tools.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>
#include <vector>

#include "haptic_agent/servo/passivity.h"
#include "tests/agent/stability/face_rest.h"

namespace kerf::agent {
namespace {

constexpr double kRestMmPerS = 2, kShakesMmPerS = 5;
constexpr std::size_t kShown = 12;

struct Run {
  std::uint32_t seed;
  FaceRest rest;
  FaceRestOutcome outcome;
};

struct Row {
  int runs = 0, above = 0, shaking = 0;
  double buzz = 0, mj = 0;
  std::uint64_t trips = 0;

  void take(const FaceRestOutcome& o) {
    ++runs;
    above += o.buzz_mm_per_s > kRestMmPerS ? 1 : 0;
    shaking += o.buzz_mm_per_s > kShakesMmPerS ? 1 : 0;
    buzz = std::max(buzz, o.buzz_mm_per_s);
    mj = std::max(mj, o.returned_mj);
    trips += o.trips;
  }
  void print(const char* name) const {
    std::printf("%-14s %6d %8d %8d %14.2f %14.2f %6llu\n", name, runs, above, shaking, buzz, mj,
                static_cast<unsigned long long>(trips));
  }
};

void print_worst(std::vector<Run>& runs) {
  std::ranges::sort(runs, std::greater<>{}, [](const Run& r) { return r.outcome.buzz_mm_per_s; });
  for (const Run& r : runs) {
    if (!(r.outcome.buzz_mm_per_s > kRestMmPerS) || &r == runs.data() + kShown) break;
    const PlantMechanics& m = r.rest.mechanics;
    std::printf(
        "  seed %u: %.2f mm/s, moved %.2f mm, given %.3f mJ, %.2f N, %llu trips; %s on %s,"
        " tilt %.2f, %.2f kg, %.1e kg m2, %.2f N/mm, %.0f N mm/rad, ratio %.2f, %llu us,"
        " %.1f mm deep, round trip %.0f ms\n",
        r.seed, r.outcome.buzz_mm_per_s, r.outcome.moved_at_rest_mm, r.outcome.given_at_rest_mj,
        r.outcome.force_n, static_cast<unsigned long long>(r.outcome.trips),
        kFaceTools[r.rest.tool].name, r.rest.obstacle ? "an obstacle" : "stock", r.rest.tilt_rad,
        m.mass_kg, m.inertia_kg_m2, m.hand_n_per_mm, m.hand_nmm_per_rad, m.damping_ratio,
        static_cast<unsigned long long>(m.latency_us), r.rest.depth_mm, r.rest.line.rtt_ms);
  }
}

}  // namespace

bool tools_table(int runs, std::uint32_t first_seed) {
  std::array<Row, kFaceTools.size()> rows;
  Row all;
  std::vector<Run> kept;
  for (std::uint32_t n = 0; n < static_cast<std::uint32_t>(runs); ++n) {
    const FaceRest rest = random_face_rest(first_seed + n);
    kept.push_back({first_seed + n, rest, rest_on_face(rest)});
    rows[rest.tool].take(kept.back().outcome);
    all.take(kept.back().outcome);
  }
  std::printf("%-14s %6s %8s %8s %14s %14s %6s\n", "tool at rest", "runs", "> 2 mm/s", "> 5 mm/s",
              "worst mm/s rms", "mJ returned", "trips");
  for (std::size_t n = 0; n < rows.size(); ++n) rows[n].print(kFaceTools[n].name);
  all.print("all");
  print_worst(kept);
  return all.above == 0 && all.mj <= PassivitySettings{}.tank_mj;
}

}  // namespace kerf::agent
