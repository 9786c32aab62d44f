// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>

#include "kernel/piece/bounds.h"
#include "kernel/sculpture.h"
#include "server/wire/types.h"

namespace kerf::agent {

/// The tool of another participant near this agent's. Its poses arrive a round trip after the
/// server has this agent's samples of the same moment. Its path up to now is predicted from them
/// and cut in the block that gives the agent's force. All times are those of this agent's samples,
/// us.
class OtherTool {
 public:
  /// Adds a pose from the server at the time of this agent's newest sample. Ignores a pose less
  /// than 1 ms after the newest one, because the server repeats the pose of a tool that sends no
  /// more.
  void take(const wire::Intent& intent, std::uint64_t now_us);
  /// Returns whether a pose has arrived lately.
  bool is_present(std::uint64_t now_us) const;
  /// Returns the expected pose of the tool, on the circle and with the change of speed of its last
  /// poses. Requires a pose.
  ToolPose at(std::uint64_t time_us) const;
  /// Returns whether the tool cuts or has cut lately.
  bool is_cutting(std::uint64_t now_us) const;
  /// Returns whether the block has cuts that the tool did not make: they are more than `off_mm` off
  /// the path as known and expected since the last call, or belong to forgotten poses.
  bool is_off(std::uint64_t now_us, double off_mm);
  /// Returns whether the block has cuts of this tool.
  bool has_cut() const { return has_cut_; }
  /// Number of known poses. For tests.
  std::size_t poses() const { return known_.size(); }

  /// Forgets all poses: the tool is gone until a newer one arrives.
  void forget();
  /// Call when the block has been restored without this tool's cuts.
  void restart();
  /// Removes from `block` the cuts of the tool within `reach` until now that the block may lack:
  /// those of the last poses that have arrived, because the server's tiles may arrive after them,
  /// and of the expected path.
  void cut(Sculpture& block, const Bounds& reach, std::uint64_t now_us);

 private:
  /// Least time between two poses; closer ones are ignored. The server sends them 10 ms apart.
  static constexpr std::int64_t kStepMinUs = 1000;
  struct Known {
    std::int64_t time_us = 0;  ///< on the other participant's clock
    ToolPose pose;
    bool cuts = false;  ///< the motion to this pose cuts
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
  std::int64_t newest_us_ = -kStepMinUs;  ///< newest pose, on the other participant's clock
  std::deque<Known> known_;
  double offset_us_ = 0;                 ///< this agent's time minus the other's, of one moment
  Vec3 velocity_mm_per_s_, turn_per_s_;  ///< at the newest pose; the axis changes by `turn_per_s_`
  Vec3 inward_;                          ///< unit, towards the center of the circle
  double curvature_per_mm_ = 0, speed_up_mm_per_s2_ = 0;
  Vec3 cut_at(std::uint64_t time_us) const;

  bool is_new_ = false;        ///< a pose has arrived since the last call of is_off
  bool is_known_cut_ = false;  ///< the received poses have been cut
  bool has_cut_ = false;
  bool is_dropped_ = false;  ///< the block has cuts of forgotten poses
  std::deque<Placed> cut_;   ///< poses up to which the path has been cut or was out of reach
};

}  // namespace kerf::agent
