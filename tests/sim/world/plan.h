// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/sim/os/scheduler.h"

namespace kerf::sim {

/// Something that happens to a server, to NATS, or to those between.
enum class Fault : std::uint8_t {
  kKill,          ///< SIGKILL; it is started again after `length`
  kPowerLoss,     ///< as kKill, and what was not synchronized is lost
  kRestart,       ///< SIGTERM; it is started again after `length`
  kStandStill,    ///< SIGSTOP, SIGCONT
  kCut,           ///< its connections
  kDiskFull,      ///< for `length`
  kDiskFails,     ///< writes and synchronizing fail for `length`
  kNoSync,        ///< synchronizing fails for `length`
  kDiskSlow,      ///< synchronizing takes up to a second for `length`
  kNoMemory,      ///< large allocations for requests fail for `length`
  kClockForward,  ///< its wall clock, by days
  kClockBack,
  kNatsGone,     ///< for `length`
  kNatsEarlier,  ///< for `length`, and comes back with the store of `length` before
  kNatsCutOff,   ///< this server from NATS, for `length`
  kBusy,         ///< other programs use its cores for `length`: its threads are late
};
inline constexpr int kFaults = 16;
const char* to_string(Fault fault);

struct PlannedFault {
  Time at = 0;
  Fault fault = Fault::kKill;
  std::size_t server = 0;
  Time length = 0;
  bool for_good = false;  ///< of kKill and kPowerLoss: the server is not started again
};

/// A world and what happens in it: all of it follows from the seed.
struct Plan {
  std::uint64_t seed = 1;
  int servers = 1;  ///< more than one share their sessions at NATS
  int hands = 2, clerks = 1, pages = 0;
  Time length = 6 * kSecond;       ///< how long they work
  Time period = 4 * kMillisecond;  ///< of a hand's samples
  double switch_chance = 0.01;
  double clock_rates[3] = {1, 1, 1};
  bool follows = false;   ///< servers of a cluster follow each other's sessions
  double nats_loses = 0;  ///< requests to NATS, and as many answers
  bool snapshots_often = false;
  std::vector<PlannedFault> faults;  ///< by time
};

/// The plan of a seed.
Plan plan_of(std::uint64_t seed);
std::string describe(const Plan& plan);

}  // namespace kerf::sim
