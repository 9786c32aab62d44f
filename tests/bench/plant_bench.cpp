// SPDX-License-Identifier: Apache-2.0
// Measures passivity and stability of the agent at the motors and the hand: the work of the wrench
// that acts, which is the one written a latency ago.
//
//   plant_bench [all | traces] [TRACES]                            default: all, 100000
//   plant_bench surfaces [0 | 1 | 2 | 3]                           one latency, ms, or each
//   plant_bench guides [0 | 3]
//   plant_bench surround [0 | 3]
//   plant_bench random | resting [RUNS] [MOST_MS] [SEED]           default: 1000, 3, 1
//   plant_bench tools [RUNS] [SEED]                                default: 1000, 1
//
// The parts can be run separately, each for minutes. The latencies of a table can run in parallel.
//
// First table: the tool is pressed against stock and obstacles by hands of 0.02 to 2 N/mm with 0.05
// to 2 kg and 1e-5 or 2e-4 kg m², through a device with 0 to 3 ms of latency and 0 or 2 % of lost
// ticks, and a real session at a round trip of 0 to 250 ms. For each latency it has the greatest
// energy returned over any interval, the greatest rms speed of the tip while the hand is at rest,
// and the trips. The last rows declare no latency where there are 3 ms, and do not declare the
// inertia by which a push turns a pen instead of moving it. Then the same hands press against
// guides of each kind instead of surfaces, at a round trip of 50 ms. Then stock appears around the
// tool in a slot, by undo and redo or by the change to a larger tool, with the cutting button
// pressed or not, at round trips of 0, 50 and 250 ms; for runs that are too fast at rest it also
// prints the hand, how far the tip moved meanwhile, and the work of the device on the hand. Then
// random traces of two seconds with an adversarial network (tests/agent/servo/adversary.h), and the
// same with deliberate errors. `random` presses with random devices, hands, latencies up to
// MOST_MS, lost ticks, lines, surfaces and guides, and prints the worst three runs of each measure.
// `resting`: random devices, hands, tools and forces in the slot with the cutting button pressed.
// `tools`: random tools, tilted and upright, rest on faces. Fails if the tank is exceeded, a wrench
// leaves its limits, or the tip moves faster than 5 mm/s rms (2 mm/s with `tools`).
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/agent/servo/adversary.h"
#include "tests/agent/stability/experiments.h"
#include "tests/agent/stability/surround.h"
#include "tests/bench/plant_tools.h"

namespace {

using namespace kerf::agent;

constexpr double kMostBuzz = 5;
/// Latencies of the rows, ms.
constexpr int kSurfaceMs[] = {0, 1, 2, 3};
constexpr int kGuideMs[] = {0, 3};
constexpr double kTankMj = PassivitySettings{}.tank_mj;

struct Worst {
  double returned_mj = 0, buzz_mm_per_s = 0;
  std::uint64_t trips = 0;
  int runs = 0;

  void take(const PressOutcome& outcome) {
    returned_mj = std::max(returned_mj, outcome.returned_mj);
    buzz_mm_per_s = std::max(buzz_mm_per_s, outcome.buzz_mm_per_s);
    trips += outcome.trips;
    ++runs;
  }
};

/// Presses with hands of all mechanics, along and across the tool's axis, with and without lost
/// ticks.
void press_with_all_hands(Press press, Worst& worst) {
  for (const double mass_kg : {0.05, 0.3, 2.0}) {
    for (const double inertia_kg_m2 : {1e-5, 2e-4}) {
      for (const double n_per_mm : {0.02, 0.2, 2.0}) {
        press.mechanics = {.mass_kg = mass_kg,
                           .inertia_kg_m2 = inertia_kg_m2,
                           .hand_n_per_mm = n_per_mm,
                           .hand_nmm_per_rad = 670 * n_per_mm,
                           .latency_us = press.mechanics.latency_us};
        for (const bool sideways : {false, true}) {
          for (const bool loses : {false, true}) {
            press.sideways = sideways;
            press.loses_ticks = loses;
            worst.take(kerf::agent::press(press));
          }
        }
      }
    }
  }
}

Worst press_all(std::uint64_t latency_us, bool ignores_latency, bool ignores_inertia = false) {
  Worst worst;
  for (const double rtt_ms : {0.0, 50.0, 250.0}) {
    for (const bool obstacle : {false, true}) {
      Press press{.line = {.rtt_ms = rtt_ms, .jitter = rtt_ms > 0 ? 0.2 : 0},
                  .obstacle = obstacle,
                  .ignores_latency = ignores_latency,
                  .ignores_inertia = ignores_inertia};
      press.mechanics.latency_us = latency_us;
      press_with_all_hands(press, worst);
    }
  }
  return worst;
}

Worst press_guides(std::uint64_t latency_us) {
  Worst worst;
  for (const char* guides : kPressedGuides) {
    Press press{.line = {.rtt_ms = 50, .jitter = 0.2}, .guides = guides};
    press.mechanics.latency_us = latency_us;
    press_with_all_hands(press, worst);
  }
  return worst;
}

struct Rest {
  PlantMechanics mechanics;
  double rtt_ms;
  SurroundOutcome outcome;
};

/// `above` receives the runs that move too fast at rest.
Worst surround_all(std::uint64_t latency_us, Surrounding by, bool cutting,
                   std::vector<Rest>& above) {
  Worst worst;
  for (const double rtt_ms : {0.0, 50.0, 250.0}) {
    for (const double mass_kg : {0.05, 0.3, 2.0}) {
      for (const double inertia_kg_m2 : {1e-5, 2e-4}) {
        for (const double n_per_mm : {0.02, 0.2, 2.0}) {
          const PlantMechanics mechanics{.mass_kg = mass_kg,
                                         .inertia_kg_m2 = inertia_kg_m2,
                                         .hand_n_per_mm = n_per_mm,
                                         .hand_nmm_per_rad = 670 * n_per_mm,
                                         .latency_us = latency_us};
          const SurroundOutcome outcome =
              surround({.mechanics = mechanics,
                        .line = {.rtt_ms = rtt_ms, .jitter = rtt_ms > 0 ? 0.2 : 0},
                        .by = by,
                        .cutting = cutting,
                        .loses_ticks = true});
          if (outcome.buzz_mm_per_s > kMostBuzz) above.push_back({mechanics, rtt_ms, outcome});
          worst.take({.returned_mj = outcome.returned_mj,
                      .buzz_mm_per_s = outcome.buzz_mm_per_s,
                      .trips = outcome.trips});
        }
      }
    }
  }
  return worst;
}

/// Prints the hand, and whether it continued to move the device, or the device the hand.
void print_rest(const Rest& run) {
  std::printf(
      "  %.2f mm/s: %.2f kg, %.0e kg m2, %.2f N/mm, round trip %.0f ms;"
      " moved %.2f mm, given %.4f mJ\n",
      run.outcome.buzz_mm_per_s, run.mechanics.mass_kg, run.mechanics.inertia_kg_m2,
      run.mechanics.hand_n_per_mm, run.rtt_ms, run.outcome.moved_at_rest_mm,
      run.outcome.given_at_rest_mj);
}

/// `only_ms` is the latency of the rows to run, or negative for all.
bool contact_table(bool surfaces, bool guides, bool around, int only_ms) {
  bool holds = true;
  std::printf("%-26s %6s %14s %20s %6s\n", "latency ms", "runs", "mJ returned", "rms mm/s at rest",
              "trips");
  const auto row = [](const std::string& name, const Worst& worst) {
    std::printf("%-26s %6d %14.2f %20.2f %6llu\n", name.c_str(), worst.runs, worst.returned_mj,
                worst.buzz_mm_per_s, static_cast<unsigned long long>(worst.trips));
    std::fflush(stdout);
  };
  const auto runs = [only_ms](int ms) { return only_ms < 0 || ms == only_ms; };
  const auto us = [](int ms) { return static_cast<std::uint64_t>(ms) * 1000; };
  for (const int ms : kSurfaceMs) {
    if (!surfaces || !runs(ms)) continue;
    const Worst worst = press_all(us(ms), false);
    row(std::to_string(ms), worst);
    holds = holds && worst.returned_mj <= kTankMj && worst.buzz_mm_per_s <= kMostBuzz;
  }
  if (surfaces && only_ms < 0) row("3, but none declared", press_all(3000, true));
  if (surfaces && only_ms < 0) row("3, no limit from inertia", press_all(3000, false, true));
  for (const int ms : kGuideMs) {
    if (!guides || !runs(ms)) continue;
    const Worst worst = press_guides(us(ms));
    row(std::to_string(ms) + ", guides", worst);
    holds = holds && worst.returned_mj <= kTankMj && worst.buzz_mm_per_s <= kMostBuzz;
  }
  for (const int ms : kGuideMs) {
    if (!around || !runs(ms)) continue;
    for (const auto& [by, name] : {std::pair{Surrounding::kNothing, ", nothing appears"},
                                   std::pair{Surrounding::kUndo, ", undo"},
                                   std::pair{Surrounding::kLargerTool, ", larger tool"}}) {
      for (const bool cutting : {false, true}) {
        std::vector<Rest> above;
        const Worst worst = surround_all(us(ms), by, cutting, above);
        row(std::to_string(ms) + name + (cutting ? ", cutting" : ""), worst);
        for (const Rest& run : above) print_rest(run);
        holds = holds && worst.returned_mj <= kTankMj && worst.buzz_mm_per_s <= kMostBuzz;
      }
    }
  }
  return holds;
}

Press random_press(std::uint32_t seed, double most_ms) {
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto log_uniform = [&](double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  };
  const auto one_of = [&](std::size_t count) {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(random);
  };
  Press press{.mechanics = {.mass_kg = log_uniform(0.05, 2),
                            .inertia_kg_m2 = log_uniform(1e-5, 1e-3),
                            .hand_n_per_mm = log_uniform(0.02, 2),
                            .hand_nmm_per_rad = log_uniform(10, 2000),
                            .latency_us = static_cast<std::uint64_t>(uniform(0, 1000 * most_ms))},
              .line = {.rtt_ms = uniform(0, 250), .jitter = uniform(0, 0.3)}};
  if (one_of(2) == 1) press.line.loss = uniform(0, 0.03);
  press.sideways = one_of(2) == 1;
  press.loses_ticks = one_of(2) == 1;
  const std::size_t surface = one_of(2 + std::size(kPressedGuides));
  press.obstacle = surface == 1;
  if (surface > 1) press.guides = kPressedGuides[surface - 2];
  return press;
}

Surround random_rest(std::uint32_t seed, double most_ms) {
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const auto log_uniform = [&](double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  };
  const double hand_n_per_mm = log_uniform(0.02, 2);
  Surround rest{.mechanics = {.mass_kg = log_uniform(0.05, 2),
                              .inertia_kg_m2 = log_uniform(1e-5, 1e-3),
                              .hand_n_per_mm = hand_n_per_mm,
                              .hand_nmm_per_rad = hand_n_per_mm * uniform(300, 1500),
                              .latency_us = static_cast<std::uint64_t>(uniform(0, 1000 * most_ms))},
                .line = {.rtt_ms = uniform(0, 250), .jitter = uniform(0, 0.3)},
                .cutting = true};
  rest.by = static_cast<Surrounding>(std::uniform_int_distribution<int>(0, 2)(random));
  rest.loses_ticks = uniform(0, 1) < 0.5;
  rest.flat = uniform(0, 1) < 0.5;
  rest.force_n_per_mm2 = log_uniform(0.03, 0.3);
  rest.swing_mm = uniform(0.5, 6);
  rest.swing_s = uniform(1.2, 2.4);
  return rest;
}

bool resting_table(int runs, double most_ms, std::uint32_t first_seed) {
  std::vector<std::pair<double, std::uint32_t>> buzz;
  double mj = 0;
  for (std::uint32_t n = 0; n < static_cast<std::uint32_t>(runs); ++n) {
    const SurroundOutcome outcome = surround(random_rest(first_seed + n, most_ms));
    buzz.emplace_back(outcome.buzz_mm_per_s, first_seed + n);
    mj = std::max(mj, outcome.returned_mj);
  }
  std::ranges::sort(buzz, std::greater<>{});
  const auto above =
      std::ranges::count_if(buzz, [](const auto& run) { return run.first > kMostBuzz; });
  std::printf("%d tools that rest in their cuts: at most %.2f mJ returned; %td above %.0f mm/s:",
              runs, mj, above, kMostBuzz);
  for (std::size_t n = 0; n < std::min<std::size_t>(buzz.size(), 5); ++n)
    std::printf(" %.2f (seed %u)", buzz[n].first, buzz[n].second);
  std::printf("\n");
  return mj <= kTankMj && above == 0;
}

bool random_table(int runs, double most_ms, std::uint32_t first_seed) {
  struct Run {
    std::uint32_t seed;
    bool loses_messages;  // forces fade and return, and move the tip, whenever a message is late
    PressOutcome outcome;
  };
  std::vector<Run> all;
  for (std::uint32_t n = 0; n < static_cast<std::uint32_t>(runs); ++n) {
    const Press one = random_press(first_seed + n, most_ms);
    all.push_back({first_seed + n, one.line.loss > 0, press(one)});
  }
  const auto worst = [&](const char* name, const auto& of) {
    constexpr std::size_t kShown = 3;
    const std::size_t count = std::min(kShown, all.size());
    std::ranges::partial_sort(all, all.begin() + static_cast<std::ptrdiff_t>(count),
                              std::greater<>{}, of);
    std::printf("%s:", name);
    for (std::size_t n = 0; n < count; ++n) {
      const Press press = random_press(all[n].seed, most_ms);
      std::printf(" %.2f (seed %u: %.2f kg, %.1e kg m2, %.2f N/mm, %.2f ms)", of(all[n]),
                  all[n].seed, press.mechanics.mass_kg, press.mechanics.inertia_kg_m2,
                  press.mechanics.hand_n_per_mm,
                  static_cast<double>(press.mechanics.latency_us) / 1000);
    }
    std::printf("\n");
    return all.empty() ? 0.0 : of(all.front());
  };
  std::printf("%d random presses, latencies up to %.0f ms\n", runs, most_ms);
  const double mj = worst("mJ returned", [](const Run& r) { return r.outcome.returned_mj; });
  const double buzz = worst("rms mm/s at rest, if no message is lost", [](const Run& r) {
    return r.loses_messages ? 0.0 : r.outcome.buzz_mm_per_s;
  });
  worst("trips", [](const Run& r) { return static_cast<double>(r.outcome.trips); });
  return mj <= kTankMj && buzz <= kMostBuzz;
}

bool adversary_table(std::uint32_t traces) {
  constexpr int kTicks = 2000;
  constexpr std::uint32_t kFaultyTraces = 1001;
  const WorstReturn worst = worst_return<CarryDeficit>(0, traces, kTicks);
  std::printf(
      "\n%u adversarial traces: at most %.2f mJ returned (seed %u), tank %.0f mJ, limits %s\n",
      traces, worst.returned_mj, worst.seed, kTankMj, worst.kept_limits ? "kept" : "BROKEN");
  const auto fault = [&]<typename Deficit>(const char* name, const AdversaryFaults& faults,
                                           Deficit) {
    const WorstReturn broken = worst_return<Deficit>(0, kFaultyTraces, kTicks, faults);
    std::printf("%s: %.0f mJ (seed %u)\n", name, broken.returned_mj, broken.seed);
  };
  fault("latency not declared", {.ignores_latency = true}, CarryDeficit{});
  fault("20 times the mass declared", {.declares_too_much_mass = true}, CarryDeficit{});
  fault("the same, and deficits forgiven", {.declares_too_much_mass = true}, ForgiveDeficit{});
  fault("pens of 1e-5 kg m2", {.lightest_pen = true}, CarryDeficit{});
  fault("the same, their damper not limited", {.lightest_pen = true, .damps_turning_freely = true},
        CarryDeficit{});
  fault("the same, the energy to turn them not counted",
        {.lightest_pen = true, .ignores_turning = true}, CarryDeficit{});
  fault("neither", {.lightest_pen = true, .damps_turning_freely = true, .ignores_turning = true},
        CarryDeficit{});
  return worst.kept_limits && worst.returned_mj <= kTankMj;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view part = argc > 1 ? argv[1] : "all";
  const int number = argc > 2 ? std::atoi(argv[2]) : -1;
  const auto runs = [&](std::string_view name) { return part == "all" || part == name; };
  const auto argument = [&](int n, int otherwise) {
    return argc > n ? std::atoi(argv[n]) : otherwise;
  };
  if (part == "tools")
    return tools_table(argument(2, 1000), static_cast<std::uint32_t>(argument(3, 1))) ? 0 : 1;
  if (part == "random" || part == "resting") {
    const auto table = part == "random" ? random_table : resting_table;
    return table(argument(2, 1000), argument(3, 3), static_cast<std::uint32_t>(argument(4, 1))) ? 0
                                                                                                : 1;
  }
  const bool of_latency = part == "surfaces" || part == "guides" || part == "surround";
  const std::span<const int> rows =
      part == "surfaces" ? std::span<const int>(kSurfaceMs) : kGuideMs;
  const bool has_rows = number < 0 || std::ranges::find(rows, number) != rows.end();
  if ((!of_latency && part != "all" && part != "traces") || (of_latency && !has_rows)) {
    std::fprintf(stderr,
                 "plant_bench [all | traces] [TRACES]\nplant_bench surfaces [0 | 1 | 2 | 3]\n"
                 "plant_bench guides [0 | 3]\nplant_bench surround [0 | 3]\n"
                 "plant_bench random | resting [RUNS] [MOST_MS] [SEED]\n"
                 "plant_bench tools [RUNS] [SEED]\n");
    return 2;
  }
  bool holds = true;
  if (part == "all" || of_latency) {
    holds = contact_table(runs("surfaces"), runs("guides"), runs("surround"),
                          part == "all" ? -1 : number);
  }
  if (runs("traces"))
    holds = adversary_table(number < 0 ? 100'000 : static_cast<std::uint32_t>(number)) && holds;
  return holds ? 0 : 1;
}
