// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "tests/sim/os/scheduler.h"

namespace kerf::sim {

/// A guest, who keeps on requesting changes that guests may not make. Each must be rejected,
/// whatever happens to the servers.
class Intruder {
 public:
  Intruder(std::string session, std::vector<int> ports, std::uint64_t seed);
  void start(Time end, Time pause_max);
  void join() { thread_.join(); }

  // ---- after join() ----
  std::uint64_t requests() const { return requests_; }
  /// Answers other than a rejection: a line for each.
  const std::vector<std::string>& wrong_answers() const { return wrong_; }

 private:
  void try_something();
  std::uint64_t draw_own(std::uint64_t below);

  std::string session_;
  std::vector<int> ports_;
  std::uint64_t random_, requests_ = 0;
  std::vector<std::string> wrong_;
  std::thread thread_;
};

}  // namespace kerf::sim
