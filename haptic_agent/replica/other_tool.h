// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>

#include "kernel/piece/bounds.h"
#include "kernel/sculpture.h"
#include "server/wire/types.h"

namespace kerf::agent {

/// The tool of another participant near this agent's. Its poses arrive a round trip after the
/// server has this agent's samples of the same moment, so its path up to now is predicted from
/// them, and cut in a block from which the agent's force is computed. All times are those of this
/// agent's samples, us.
class OtherTool {
 public:
  /// Takes a pose from the server at the time of this agent's newest sample. A pose less than 1 ms
  /// after the newest one is left out: the server repeats the pose of a tool that sends no more.
  void take(const wire::Intent& intent, std::uint64_t now_us);
  /// Returns whether a pose has arrived lately.
  bool is_present(std::uint64_t now_us) const;
  /// Returns where the tool is expected: on the circle, and with the change of speed, of its last
  /// poses. Requires a pose.
  ToolPose at(std::uint64_t time_us) const;
  /// Returns whether it has cut lately, or cuts.
  bool is_cutting(std::uint64_t now_us) const;
  /// Returns whether the block has cuts that the tool did not make: they are more than `off_mm` off
  /// the path, as known and expected since the last call, or of poses that are forgotten.
  bool is_off(std::uint64_t now_us, double off_mm);
  /// Returns whether the block has cuts of this tool.
  bool has_cut() const { return has_cut_; }
  /// The number of poses that are kept. For tests.
  std::size_t poses() const { return known_.size(); }

  /// Forgets all poses: the tool is gone until a newer one arrives.
  void forget();
  /// Forgets what has been cut: the block no longer has it.
  void restart();
  /// Removes from `block` what the tool cuts within `reach` until now and `block` may still have:
  /// the last poses that have arrived, because the server's tiles may arrive after them, and the
  /// expected path.
  void cut(Sculpture& block, const Bounds& reach, std::uint64_t now_us);

 private:
  /// Poses less than this apart are left out. The server sends them 10 ms apart.
  static constexpr std::int64_t kStepMinUs = 1000;
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
  void cut_known(Sculpture& block, const Bounds& reach, std::uint64_t now_us);
  void cut_to(Sculpture& block, const Bounds& reach, const Placed& to);

  ToolId tool_ = 0;
  std::int64_t newest_us_ = -kStepMinUs;  ///< of the other's clock: the newest pose ever taken
  std::deque<Known> known_;
  double offset_us_ = 0;  ///< this agent's time of a sample less the other's, of one moment
  Vec3 velocity_mm_per_s_, turn_per_s_;  ///< of the newest pose; the axis changes by `turn_per_s_`
  Vec3 inward_;                          ///< unit, towards the center of the circle
  double curvature_per_mm_ = 0, speed_up_mm_per_s2_ = 0;
  Vec3 cut_at(std::uint64_t time_us) const;

  bool is_new_ = false;        ///< a pose has arrived since the last call of is_off
  bool is_known_cut_ = false;  ///< the poses that have arrived have been cut
  bool has_cut_ = false;
  bool is_dropped_ = false;  ///< the block has cuts of poses that are forgotten
  std::deque<Placed> cut_;  ///< poses up to which the path has been cut, where not within reach too
};

}  // namespace kerf::agent
