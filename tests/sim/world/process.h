// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "tests/sim/os/scheduler.h"
#include "tests/sim/world/plan.h"
#include "tests/sim/world/world.h"

namespace kerf::sim {

/// The outcome of a world, as its process reports it.
struct Report {
  bool is_whole = false;  ///< it has come to its end
  std::string faults;     ///< a line for each promise that was broken
  std::uint64_t motions = 0, promises = 0, requests = 0, trace = 0, turns = 0;
  Time length = 0;   ///< that has passed in the world
  double cpu_s = 0;  ///< that it took
  bool is_good() const { return is_whole && faults.empty(); }
};

/// Simulates `life` in a process of its own, because a simulation lasts as long as its process.
/// `folder` is emptied; the server's log is there afterwards.
Report run_apart(const TurnOptions& turns, const std::filesystem::path& folder,
                 const std::function<Outcome()>& life);
/// The same with a world, the disks of whose machines are in `folder`.
Report run_world(const Plan& plan, const std::filesystem::path& folder);

}  // namespace kerf::sim
