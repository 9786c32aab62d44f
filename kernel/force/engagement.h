// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "kernel/force/travel_queue.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// mm of travel over which the removed volume and the direction of motion are averaged. Shorter
/// travel is tremor of the human hand and encoder noise. If it grows, the force lags more: by half
/// of it, and by all of it at a corner.
inline constexpr double kFeltTravelMm = 0.01;

/// Pending sums of the mechanistic law, and the angle of the spindle.
struct MillingEngagement {
  explicit MillingEngagement(double pitch_mm) : gradual(pitch_mm), prompt(kFeltTravelMm / 2) {}

  TravelQueueOf<MillingSum> gradual, prompt;  ///< as in Engagement
  double turns = 0;                           ///< of the spindle since the cut began, below 1
  /// Unit vector across the tool's axis, from which angles count. It turns with the tool. Zero
  /// before an engagement begins.
  Vec3 zero;
};

/// The cut volume of one user of a tool that is not yet delivered as force, carried from one motion
/// to the next.
struct Engagement {
  explicit Engagement(double pitch_mm) : gradual(pitch_mm), prompt(kFeltTravelMm / 2) {}

  /// Turns with the tool: pending amounts keep their position on the tool and their torque about
  /// the pivot.
  void turn(const Turn& turn) {
    gradual.turn(turn);
    prompt.turn(turn);
    center_mm = turn(center_mm);
    if (!milling) return;
    milling->gradual.turn(turn);
    milling->prompt.turn(turn);
    milling->zero = turn(milling->zero);
  }

  TravelQueue gradual;         ///< columns removed whole by a wall parallel to the rays
  TravelQueue prompt;          ///< everything else
  Vec3 center_mm;              ///< centroid of the last delivered volume, relative to the tip
  Vec3 direction;              ///< mean direction of that centroid over kFeltTravelMm; length <= 1
  double crossing_per_mm = 1;  ///< in the last cut: distance across columns over path
  std::unique_ptr<MillingEngagement> milling;  ///< for the mechanistic law only
};

/// Where the last motion of a user of a tool ended.
struct ToolUser {
  std::uint32_t tool = 0;
  ToolPose at;
};

/// The engagements of all users who carve one block. A user is identified by tool and pose: a
/// motion that starts where another one of the same tool ended continues its engagement; any other
/// motion starts a new one. Whether a motion continues does not depend on which motions were felt.
class Engagements {
 public:
  explicit Engagements(double pitch_mm) : pitch_mm_(pitch_mm) {}

  /// The engagement of a motion. A motion that does not continue another may begin inside stock.
  struct Followed {
    std::shared_ptr<Engagement> engagement;
    bool continues;
  };
  /// Returns the engagement of a motion of `tool` from `from` to `to`. If the motion is not `felt`,
  /// drops the pending force.
  Followed follow(std::uint32_t tool, const ToolPose& from, const ToolPose& to, bool felt);
  /// Drops the engagements of a tool, because it was redefined.
  void forget(std::uint32_t tool);
  /// Drops the engagements of the users for which drops(tool, pose) is true.
  template <class Drops>
  void forget_if(Drops&& drops) {
    std::erase_if(users_, [&](const User& user) { return drops(user.tool, user.at); });
  }
  /// Returns the users. The most recently moved is last.
  std::vector<ToolUser> users() const;
  /// Replaces all users by these, at most kUsersMax, with nothing pending.
  void restore(std::span<const ToolUser> users);
  /// Greatest number of simultaneous users. A further one replaces the least recently moved.
  static constexpr std::size_t kUsersMax = 256;

 private:
  struct User {
    std::uint32_t tool;
    ToolPose at;
    /// Shared by motions whose force is not finished; a later motion may begin a new engagement.
    std::shared_ptr<Engagement> engagement;
    bool pending;  ///< felt since the engagement was new
  };

  std::shared_ptr<Engagement> fresh() const { return std::make_shared<Engagement>(pitch_mm_); }

  double pitch_mm_;
  std::vector<User> users_;  ///< the most recently moved is last
};

}  // namespace kerf
