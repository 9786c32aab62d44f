// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>

#include "kernel/sculpture.h"
#include "server/wire/types.h"

namespace kerf::agent {

/// The tool of another participant near this agent's. Its poses arrive a round trip after the
/// server has this agent's samples of the same moment, so its path up to now is predicted from
/// them, and cut in a block from which the agent's force is computed. All times are those of this
/// agent's samples, us.
class OtherTool {
 public:
  /// Takes a pose from the server at the time of this agent's newest sample.
  void take(const wire::Intent& intent, std::uint64_t now_us);
  /// Returns whether a pose has arrived lately.
  bool is_present(std::uint64_t now_us) const;
  /// Returns where the tool is expected: on the circle, and with the change of speed, of its last
  /// poses. Requires a pose.
  ToolPose at(std::uint64_t time_us) const;
  /// Returns whether what has been cut is off the path, as known and expected since the last call.
  bool is_off(std::uint64_t now_us);

  /// Forgets what has been cut: the block no longer has it.
  void restart() { cut_.clear(); }
  /// Removes from `block` what the tool cuts until now and `block` may still have: the last poses
  /// that have arrived, because the server's tiles may arrive after them, and the expected path.
  void cut(Sculpture& block, std::uint64_t now_us);

 private:
  struct Known {
    std::int64_t time_us = 0;  ///< of the other's clock
    ToolPose pose;
    bool cuts = false;  ///< the motion to this pose
    std::uint64_t taken_us = 0;
  };
  struct Placed {
    std::uint64_t time_us = 0;
    ToolPose pose;
  };

  void fit();
  std::uint64_t in_time(const Known& known) const;
  void cut_known(Sculpture& block, std::uint64_t now_us);
  void cut_to(Sculpture& block, const Placed& to);

  ToolId tool_ = 0;
  std::deque<Known> known_;
  double offset_us_ = 0;  ///< this agent's time of a sample less the other's, of one moment
  Vec3 velocity_mm_per_s_, turn_per_s_;  ///< of the newest pose; the axis changes by `turn_per_s_`
  Vec3 inward_;                          ///< unit, towards the center of the circle
  double curvature_per_mm_ = 0, speed_up_mm_per_s2_ = 0;
  Vec3 cut_at(std::uint64_t time_us) const;

  bool is_new_ = false;     ///< a pose has arrived since the last call of is_off
  std::deque<Placed> cut_;  ///< poses up to which the path has been cut
};

}  // namespace kerf::agent
