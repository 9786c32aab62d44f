// SPDX-License-Identifier: Apache-2.0
#include "tests/sim/world/plan.h"

#include <algorithm>
#include <array>
#include <random>

namespace kerf::sim {
namespace {

/// The first faults are those of a server alone; the next ones need a cluster.
constexpr std::size_t kOfOne = 12, kOfCluster = 15;
/// One world in so many has a busy server.
constexpr std::uint64_t kBusyWorlds = 4;

Time between(std::mt19937_64& random, Time least, Time most) {
  return least + static_cast<Time>(random() % static_cast<std::uint64_t>(most - least + 1));
}

double choose(std::mt19937_64& random, std::initializer_list<double> values) {
  return values.begin()[random() % values.size()];
}

PlannedFault fault_of(std::mt19937_64& random, const Plan& plan) {
  PlannedFault fault{.at = between(random, 300 * kMillisecond, plan.length)};
  const std::size_t kinds = plan.servers == 1 ? kOfOne : kOfCluster;
  fault.fault = static_cast<Fault>(random() % kinds);
  fault.server = random() % static_cast<std::size_t>(plan.servers);
  fault.length = between(random, 50 * kMillisecond, 3 * kSecond);
  return fault;
}

/// Ends the first server of several for good, where that is the only thing that happens to it: an
/// agent that joins just after a start has not learned yet where else to go.
void end_first_server(Plan& plan, bool if_possible) {
  const auto is_of_first = [](const PlannedFault& fault) { return fault.server == 0; };
  const auto fault = std::ranges::find_if(plan.faults, is_of_first);
  if (!if_possible || plan.servers == 1 || std::ranges::count_if(plan.faults, is_of_first) != 1) {
    return;
  }
  fault->for_good = fault->fault == Fault::kKill || fault->fault == Fault::kPowerLoss;
}

}  // namespace

const char* to_string(Fault fault) {
  constexpr std::array<const char*, kFaults> kNames = {
      "kill",       "power-loss",   "restart",      "stand-still", "cut",           "disk-full",
      "disk-fails", "no-sync",      "disk-slow",    "no-memory",   "clock-forward", "clock-back",
      "nats-gone",  "nats-earlier", "nats-cut-off", "busy"};
  return kNames[static_cast<std::size_t>(fault)];
}

Plan plan_of(std::uint64_t seed) {
  std::mt19937_64 random(seed * 0x9e3779b97f4a7c15 + 7);
  Plan plan{.seed = seed,
            .servers = random() % 3 == 0 ? 2 + static_cast<int>(random() % 2) : 1,
            .hands = 1 + static_cast<int>(random() % 3),
            .clerks = static_cast<int>(random() % 3),
            .pages = static_cast<int>(random() % 3)};
  plan.length = between(random, 2 * kSecond, plan.servers == 1 ? 6 * kSecond : 12 * kSecond);
  plan.period = between(random, 2 * kMillisecond, 12 * kMillisecond);
  plan.switch_chance = choose(random, {0.001, 0.01, 0.1});
  for (double& rate : plan.clock_rates) rate = choose(random, {1, 1, 0.95, 1.05});
  plan.follows = random() % 2 == 0;
  plan.nats_loses = choose(random, {0, 0, 0.01});
  plan.snapshots_often = random() % 2 == 0;
  for (std::uint64_t count = random() % 5; count > 0; --count) {
    plan.faults.push_back(fault_of(random, plan));
  }
  std::ranges::sort(plan.faults, {}, &PlannedFault::at);
  end_first_server(plan, random() % 2 == 0);
  if (random() % kBusyWorlds == 0) {
    PlannedFault busy = fault_of(random, plan);
    busy.fault = Fault::kBusy;
    plan.faults.push_back(busy);
    std::ranges::sort(plan.faults, {}, &PlannedFault::at);
  }
  return plan;
}

std::string describe(const Plan& plan) {
  std::string text = "seed " + std::to_string(plan.seed) + ": " + std::to_string(plan.servers) +
                     " server(s), " + std::to_string(plan.hands) + " hand(s), " +
                     std::to_string(plan.clerks) + " clerk(s), " + std::to_string(plan.pages) +
                     " page(s), " + std::to_string(plan.length / kMillisecond) + " ms, switch " +
                     std::to_string(plan.switch_chance) + (plan.follows ? ", follows" : "");
  for (std::size_t i = 0; i < plan.faults.size(); ++i) {
    const PlannedFault& fault = plan.faults[i];
    text += "\n  fault " + std::to_string(i) + ": at " + std::to_string(fault.at / kMillisecond) +
            " ms " + to_string(fault.fault) + " of server " + std::to_string(fault.server) +
            (fault.for_good ? " for good"
                            : " for " + std::to_string(fault.length / kMillisecond) + " ms");
  }
  return text;
}

}  // namespace kerf::sim
