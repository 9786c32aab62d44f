// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "haptic_agent/link/server_link.h"
#include "kernel/math/vec3.h"
#include "tests/sim/os/scheduler.h"

namespace kerf::sim {

/// A motion that a hand has made.
struct HandMotion {
  std::uint32_t tool = 0;
  Vec3 from_mm, to_mm;
};

/// Somebody who carves: the agent's real link to the server, with a thread that moves the tool. No
/// three positions are on a line, so the link may leave none out, and each occurs once.
class Hand {
 public:
  /// Carves a strip of the block of its own. `number` from 0.
  /// `token`: proves its rights; empty: none.
  Hand(int number, std::string session, int port, std::uint64_t seed, std::string token = {});

  /// Connects, and moves until `end`; then it waits until all is durable, for at most `patience`.
  void start(Time end, Time period, Time patience);
  void join() { thread_.join(); }

  const std::string& name() const { return name_; }
  // ---- after join() ----
  const std::vector<HandMotion>& motions() const { return motions_; }
  const agent::LinkReport& report() const { return link_->report(); }
  /// Its ids, one after the other: another one where the server did not know it any more.
  std::uint32_t participant() const { return participant_; }
  const std::vector<std::string>& notices() const { return notices_; }

 private:
  void run(Time end, Time period, Time patience);
  void move();

  std::string name_;
  double y_mm_;
  std::uint64_t random_;
  agent::SampleRing ring_;
  agent::LatestValue<agent::ServerWrench> wrenches_;
  std::unique_ptr<agent::ServerLink> link_;
  std::thread thread_;
  std::uint64_t made_ = 0, last_us_ = 0;
  std::uint32_t tool_ = 1, participant_ = 0;
  Vec3 tip_mm_;
  std::vector<HandMotion> motions_;
  std::vector<std::string> notices_;
};

}  // namespace kerf::sim
