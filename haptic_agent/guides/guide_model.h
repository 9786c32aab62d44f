// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "haptic_agent/guides/path_tree.h"
#include "haptic_agent/servo/contact_model.h"
#include "haptic_agent/servo/guidance.h"
#include "haptic_agent/servo/servo_cycle.h"
#include "server/formats/guide.h"

namespace kerf::agent {

/// Use of a guide in a run.
struct GuideUse {
  std::string kind;
  std::uint64_t ticks = 0;  ///< ticks in which it pushed or turned the tool
  double max_force_n = 0;   ///< greatest force that it requested
};

/// Computes the forces of a session's guides: damped springs on the tip, and on the axis of a path,
/// no stiffer than the device renders stably (stable_gains).
class GuideModel final : public Guidance {
 public:
  /// `settings`: those of the servo cycle, with the pivot of the session. `strength`: factor of all
  /// guides, 0 to 1. The constructor allocates; `at` does not.
  GuideModel(const std::vector<Guide>& guides, const ServoSettings& settings, double strength);

  Wrench at(const PastGrip& now) noexcept override;
  void adapt(const ServoSettings& settings) noexcept override { settings_ = settings; }

  const std::vector<GuideUse>& uses() const noexcept { return uses_; }

 private:
  struct Compiled {
    Guide guide;
    std::optional<PathTree> tree;
    /// For a stroke: direction of travel over the last heading_mm, of length <= 1, and the tip at
    /// that time.
    Vec3 heading{};
    /// For a path: the tip and the target axis in the previous tick.
    std::optional<Vec3> last_mm;
    Vec3 axis{0, 0, 1};
  };
  /// The tip, as the guides see it.
  struct Tip {
    const PastGrip& now;
    Vec3 tip_mm, arm_mm, velocity_mm_per_s;
  };

  Wrench wrench(Compiled& compiled, const Tip& tip) const noexcept;
  Wrench along_path(Compiled& compiled, const PathGuide& path, const Tip& tip) const noexcept;
  bool follow(Compiled& compiled, const PathGuide& path, Vec3 axis, double moved_mm) const noexcept;
  Wrench turn(const Compiled& compiled, const PathGuide& path, Vec3 axis_rate,
              const GuidePoint& near, const Tip& tip) const noexcept;
  Wrench taught(Compiled& compiled, const PathGuide& path, const GuidePoint& near, Vec3 moved_mm,
                const Tip& tip) const noexcept;
  /// Share of the load that each guide bears, so that all together are stable.
  double share() const noexcept {
    return 1.0 / static_cast<double>(std::max<std::size_t>(1, guides_.size()));
  }
  ContactGains gains(const Guide& guide, Vec3 normal, const Tip& tip) const noexcept;
  Wrench snap(const Guide& guide, const SnapGuide& shape, const Tip& tip) const noexcept;
  Wrench push(const Guide& guide, Vec3 normal, double depth_mm, const Tip& tip) const noexcept;

  ServoSettings settings_;
  /// Distance from the tip to the pivot of a teacher's torque.
  double session_pivot_mm_;
  double strength_;
  std::vector<Compiled> guides_;
  std::vector<GuideUse> uses_;
};

/// Reads the guides of a session from the text of its welcome. The list may be empty. The error is
/// one sentence.
std::expected<std::vector<Guide>, std::string> guides_of(std::string_view welcome);

/// Returns one line about a session's guides. Empty if there are none.
std::string guide_notice(const std::vector<Guide>& guides, double strength);

}  // namespace kerf::agent
