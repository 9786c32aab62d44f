// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "haptic_agent/servo/mapping/workspace_mapping.h"

namespace kerf::agent {

/// The button that acts as the clutch: while it is held the tool stays in the block and the hand
/// moves back, like lifting a mouse. kButtonClutch of a device always is one.
enum class ClutchButton : std::uint8_t {
  /// Only kButtonClutch.
  kOwn,
  /// The release of the deadman: the tool stays while nobody holds the device.
  kDeadman,
  /// The button that otherwise undoes, or redoes.
  kUndo,
  kRedo,
};

struct MappingSettings {
  WorkspaceMapping at_start{};
  ClutchButton clutch = ClutchButton::kOwn;
};

/// A change of the mapping while the loop runs.
struct MappingRequest {
  WorkspaceMapping mapping{};
  /// The tool stays at its position, and the mapping's points count only before the first pose.
  bool keeps_tool = true;
};

/// The mapping of a running device: follows its poses, clutch and changes. After the clutch or a
/// change has moved device space against the block, earlier answers are invalid, and the force
/// returns over kResumeUs.
class HandMapping {
 public:
  /// Time in which the force rises again.
  static constexpr std::uint64_t kResumeUs = 250'000;

  explicit HandMapping(const MappingSettings& settings) noexcept
      : map_(settings.at_start), clutch_(settings.clutch) {}

  /// Processes the newest state of the device. Returns that of the tool in the block, without the
  /// clutch buttons. The tool does not cut while the clutch is held, nor across a change.
  DeviceState follow(const DeviceState& device, std::uint64_t now_us) noexcept;
  /// Sets the mapping from the next pose on.
  void change(const MappingRequest& request) noexcept { request_ = request; }

  const SpaceMap& map() const noexcept { return map_; }
  /// The clutch is held: no force.
  bool is_away() const noexcept { return is_away_; }
  /// The newest pose is the first one after a clutch or a change.
  bool has_resumed() const noexcept { return has_resumed_; }
  /// Whether an answer to the pose measured at `pose_us` is valid under the present mapping.
  bool holds_for(std::uint64_t pose_us) const noexcept { return pose_us >= valid_from_us_; }
  /// Share of the force, 0 to 1.
  double share(std::uint64_t now_us) const noexcept;

 private:
  bool is_clutch(std::uint32_t buttons) const noexcept;
  bool take_change(Vec3 device_tip_mm) noexcept;

  SpaceMap map_;
  ClutchButton clutch_;
  std::optional<MappingRequest> request_;
  bool is_away_ = false, has_resumed_ = false;
  /// Tip of the tool in the block at the newest pose. Empty before the first.
  std::optional<Vec3> tool_mm_;
  std::uint64_t valid_from_us_ = 0;
  std::uint64_t resumed_us_ = 0;  ///< 0: never
};

}  // namespace kerf::agent
