// SPDX-License-Identifier: Apache-2.0
// Measures the agent over a slow network: the real session, block, traffic, codec and servo in
// virtual time, connected by a simulated line with delay, jitter, loss (retransmitted in order, as
// by TCP) and outages.
//
//   stability_bench [--fast | --others]
//
// First table: a light simulated hand (0.1 kg, 20 N/m) swings through stock that acts as a damper.
// For each line and mode, it has the largest damping (N s/m) up to which all runs were stable, and
// the greatest speed and returned energy of all runs. Second table: rms error of the output force
// along a recorded path, relative to the server's force without delay. Third table, the only one
// with --others: the same while another agent, behind an equal line, carves ahead and alongside.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "tests/agent/stability/experiments.h"

namespace {

using namespace kerf::agent;

/// The compared schemes: local model with a replica of the block near the tool, local model from
/// server results alone, the paper's interpolation, and the newest wrench.
struct Scheme {
  const char* name;
  ForceMode mode;
  bool copy;
};
constexpr Scheme kSchemes[] = {{"model", ForceMode::kModel, true},
                               {"results only", ForceMode::kModel, false},
                               {"interpolated", ForceMode::kInterpolated, false},
                               {"hold", ForceMode::kHold, false}};
constexpr double kRttMs[] = {0, 1, 5, 10, 25, 50, 100, 250};

struct Row {
  double stable_to = 0, fastest = 0, returned = 0;
};

Row try_dampings(const Scheme& scheme, const LineQuality& line, bool fast) {
  Row row;
  bool all = true;
  for (const double damping : {1.0, 2.0, 5.0, 10.0, 20.0}) {
    if (fast && damping < 20) continue;
    const SwingOutcome outcome = swing({.mode = scheme.mode,
                                        .line = line,
                                        .damping_n_s_per_m = damping,
                                        .seconds = fast ? 2.0 : 4.0,
                                        .copy = scheme.copy});
    all = all && outcome.stable();
    if (all) row.stable_to = damping;
    row.fastest = std::max(row.fastest, outcome.fastest_mm_per_s);
    row.returned = std::max(row.returned, outcome.returned_mj);
  }
  return row;
}

bool stability_table(bool fast) {
  bool model_is_stable = true;
  std::printf("%-8s %-7s %-12s", "RTT ms", "jitter", "loss");
  for (const Scheme& scheme : kSchemes) std::printf(" | %-25s", scheme.name);
  std::printf("\n%-29s | %s\n", "", "stable to N s/m, max mm/s, max mJ returned");
  for (const double rtt : kRttMs) {
    for (const double jitter : {0.0, 0.2}) {
      for (const double loss : {0.0, 0.01, 0.05, -1.0}) {
        const LineQuality line{
            .rtt_ms = rtt, .jitter = jitter, .loss = std::max(0.0, loss), .bursts = loss < 0};
        char name[16];
        std::snprintf(name, sizeof name, loss < 0 ? "200 ms burst" : "%.0f %%", loss * 100);
        std::printf("%-8.0f %-7.1f %-12s", rtt, jitter, name);
        for (const Scheme& scheme : kSchemes) {
          const Row row = try_dampings(scheme, line, fast);
          std::printf(" | %6.0f %8.0f %9.2f", row.stable_to, row.fastest, row.returned);
          const bool counts = scheme.mode == ForceMode::kModel;
          model_is_stable = model_is_stable && (!counts || row.stable_to >= 20);
        }
        std::printf("\n");
        std::fflush(stdout);
      }
    }
  }
  return model_is_stable;
}

double rms_n(const Recording& recording) {
  double sum = 0;
  for (const kerf::Vec3& force_n : recording.force_n) sum += dot(force_n, force_n);
  return std::sqrt(sum / static_cast<double>(recording.force_n.size()));
}

void error_table(const char* title, const Recording& recording) {
  std::printf("\n%-8s", "RTT ms");
  for (const Scheme& scheme : kSchemes) std::printf(" %12s", scheme.name);
  std::printf("   %s\n", title);
  for (const double rtt : kRttMs) {
    std::printf("%-8.0f", rtt);
    for (const Scheme& scheme : kSchemes) {
      const double error = force_error(recording, scheme.mode, {.rtt_ms = rtt}, scheme.copy);
      std::printf(" %12.1f", 100 * error);
    }
    std::printf("\n");
    std::fflush(stdout);
  }
}

void error_tables(bool fast) {
  const Recording alone = record_carving(fast ? 5 : 12);
  error_table("rms force error, %", alone);
}

/// The path of another agent relative to that of the measured one.
struct Neighbor {
  double ahead_s, beside_mm;
};
constexpr Neighbor kNeighbors[] = {{0.02, 2}, {0.05, 2}, {0.1, 2},  {0.2, 2},  {0.5, 2},
                                   {0.05, 0}, {0.05, 1}, {0.05, 3}, {0.05, 4}, {-0.05, 2}};

void others_table(bool fast) {
  std::printf("\nrms force error, %%, another user ahead and beside: with, without intent\n%-18s",
              "s ahead, mm beside");
  constexpr double kRtts[] = {0, 25, 50, 100, 250};
  for (const double rtt : kRtts) std::printf(" %9.0f ms     ", rtt);
  std::printf(" rms N alone, beside\n");
  const Recording alone = record_carving(fast ? 5 : 12);
  for (const auto& [ahead_s, beside_mm] : kNeighbors) {
    const Recording both = beside_another(alone, ahead_s, beside_mm);
    std::printf("%8.2f %9.1f", ahead_s, beside_mm);
    for (const double rtt : kRtts) {
      std::printf("  ");
      for (const bool intent : {true, false}) {
        const LineQuality line{.rtt_ms = rtt};
        std::printf(" %6.1f", 100 * force_error(both, ForceMode::kModel, line, true, intent));
        std::fflush(stdout);
      }
    }
    std::printf("   %6.2f %6.2f\n", rms_n(alone), rms_n(both));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const bool fast = argc > 1 && std::strcmp(argv[1], "--fast") == 0;
  const bool others = argc > 1 && std::strcmp(argv[1], "--others") == 0;
  if (!others) error_tables(fast);
  others_table(fast);
  if (others) return 0;
  const bool stable = stability_table(fast);
  std::printf("model mode: %s\n", stable ? "stable everywhere" : "NOT stable everywhere");
  return stable ? 0 : 1;
}
