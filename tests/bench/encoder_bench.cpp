// SPDX-License-Identifier: Apache-2.0
// Measures the force of a cut that is felt through encoders: a straight path at constant speed
// whose reported pose alone is rounded, compared with the same path without rounding. Real session,
// servo and copy of the block, in virtual time.
//
//   encoder_bench                  every law and both ray models
//   encoder_bench LAW RAYS         one: specific_energy, drr or mechanistic; dexel or tri-dexel
//   encoder_bench unknown          devices that do not state their quanta; LAW RAYS may follow
//   encoder_bench falcon           counts of a Falcon's legs, through its driver
//
// Each cell: mean of the displayed force relative to that without rounding, and rms error, %.
// `worst` has the greatest deviation of a mean and the greatest rms error, of force and torque.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "tests/agent/stability/encoder_cut.h"

namespace {

using namespace kerf::agent;

constexpr double kSpeeds[] = {1, 2, 5, 10, 20, 40};

constexpr double kLeastLeverMm = 5;

struct Worst {
  double mean = 0, rms = 0, torque_mean = 0, torque_rms = 0;
  int missed = 0, cells = 0;

  void add(const EncoderCutOutcome& cut) {
    const auto off = [](const FeltSums& sums) {
      return sums.computed_mean() > 0 ? std::abs(sums.felt_mean() / sums.computed_mean() - 1) : 1;
    };
    double off_by = off(cut.force), rms_by = cut.force.error();
    mean = std::max(mean, off_by);
    rms = std::max(rms, rms_by);
    // A tool that plunges along its axis has only the torque of rounding.
    if (cut.torque.computed_mean() > kLeastLeverMm * cut.force.computed_mean()) {
      torque_mean = std::max(torque_mean, off(cut.torque));
      torque_rms = std::max(torque_rms, cut.torque.error());
      off_by = std::max(off_by, off(cut.torque));
      rms_by = std::max(rms_by, cut.torque.error());
    }
    missed += off_by > 0.02 || rms_by > 0.05 ? 1 : 0;
    ++cells;
  }
  void print(const char* name) const {
    std::printf(
        "worst, %s: mean %.1f %%, rms %.1f %%; torque %.1f, %.1f %%; %d of %d beyond 2 or 5\n",
        name, 100 * mean, 100 * rms, 100 * torque_mean, 100 * torque_rms, missed, cells);
  }
};

void print_row(EncoderCut cut, Worst& worst) {
  std::printf("%-7s %6.3f mm", name_of(cut.path), cut.quantum_mm);
  for (const double mm_per_s : kSpeeds) {
    cut.mm_per_s = mm_per_s;
    const EncoderCutOutcome outcome = cut_by_encoder(cut);
    const FeltSums& f = outcome.force;
    const double mean = f.computed_mean() > 0 ? f.felt_mean() / f.computed_mean() : 0;
    std::printf("  %5.3f %5.1f", mean, 100 * f.error());
    std::fflush(stdout);
    worst.add(outcome);
  }
  std::printf("\n");
}

void print_table(const char* law, const char* rays, bool declared, bool falcon) {
  std::printf("\n%s, %s%s\nmm/s              ", law, rays, declared ? "" : ", quanta not stated");
  for (const double mm_per_s : kSpeeds) std::printf("  %11.0f", mm_per_s);
  std::printf("\n");
  Worst worst;
  for (const StraightCut path : kStraightCuts) {
    for (const double quantum_mm : {0.001, 0.01, 0.023, 0.043, 0.06}) {
      if (falcon && quantum_mm != 0.043) continue;
      print_row({.path = path,
                 .quantum_mm = quantum_mm,
                 .quantum_rad = quantum_mm / 60,
                 .declared = declared,
                 .falcon = falcon,
                 .law = law,
                 .rays = rays},
                worst);
    }
  }
  worst.print(law);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view first = argc > 1 ? argv[1] : "";
  const bool unknown = first == "unknown", falcon = first == "falcon";
  const int next = unknown || falcon ? 2 : 1;
  const std::string_view only_law = argc > next ? argv[next] : "";
  const std::string_view only_rays = argc > next + 1 ? argv[next + 1] : "";
  for (const char* law : {"specific_energy", "drr", "mechanistic"}) {
    if (!only_law.empty() && only_law != law) continue;
    for (const char* rays : {"dexel", "tri-dexel"}) {
      if (!only_rays.empty() && only_rays != rays) continue;
      print_table(law, rays, !unknown, falcon);
    }
  }
  return 0;
}
