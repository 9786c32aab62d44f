// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "kernel/force/travel_queue.h"
#include "kernel/tool/tool_pose.h"

namespace kerf {

/// mm of travel. Over so much what is cut, and the way it is cut, are remembered: less is the
/// tremor of a hand and the noise of an encoder. If it grows, the force lags; by half of it, twice
/// that at a corner.
inline constexpr double kFeltTravelMm = 0.01;

/// What a hand that carves with a tool still has to feel of what it has cut, from one motion to the
/// next.
struct Engagement {
  explicit Engagement(double pitch_mm) : gradual(pitch_mm), prompt(kFeltTravelMm / 2) {}

  TravelQueue gradual;  ///< columns that a wall parallel to the rays has eaten whole
  TravelQueue prompt;   ///< everything else
  Vec3 center_mm;       ///< middle of what was last felt, from the tip
  Vec3 way;             ///< the last kFeltTravelMm of the way of that middle; no longer than 1
};

/// The engagements of everyone who carves one block. Hands are told apart by where they are: a
/// motion goes on where one ended, or it begins an engagement of its own.
class Engagements {
 public:
  explicit Engagements(double pitch_mm) : pitch_mm_(pitch_mm) {}

  /// The engagement that a motion of `tool` from `from` to `to` continues.
  Engagement& follow(std::uint32_t tool, const ToolPose& from, const ToolPose& to);
  /// A tool has been redefined: nothing is left of what it cut before.
  void forget(std::uint32_t tool);

 private:
  struct Hand {
    std::uint32_t tool;
    ToolPose at;
    Engagement engagement;
  };
  /// Hands that carve at the same time; the one that has been still the longest is forgotten for a
  /// further one.
  static constexpr std::size_t kHandsMax = 256;

  double pitch_mm_;
  std::vector<Hand> hands_;  ///< the last one moved stands last
};

}  // namespace kerf
