// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "haptic_agent/servo/grip_history.h"
#include "haptic_agent/servo/server_wrench.h"

namespace kerf::agent {

/// Ranges of scale and gain.
inline constexpr double kScaleMin = 1e-3, kScaleMax = 1e3;
inline constexpr double kGainMin = 1e-2, kGainMax = 100;

/// The mapping from device space to the block: a similarity, which keeps angles (derivation in
/// README.md).
struct WorkspaceMapping {
  /// Millimeters in the block per millimeter of the device, kScaleMin to kScaleMax.
  double scale = 1;
  /// Force at the hand per force in the block, kGainMin to kGainMax.
  double gain = 1;
  /// Rotation vector from device space to the block, rad.
  Vec3 turn_rad{};
  /// This point of device space corresponds to `block_mm`.
  Vec3 device_mm{};
  /// Point of the block.
  Vec3 block_mm{};

  /// Torque about the tip at the hand per torque in the block.
  constexpr double torque_gain() const noexcept { return gain / scale; }
  /// Stiffness at the hand per stiffness in the block.
  constexpr double stiffness_scale() const noexcept { return gain * scale; }

  friend bool operator==(const WorkspaceMapping&, const WorkspaceMapping&) = default;
};

/// A box with edges parallel to the axes of its space.
struct SpaceBox {
  Vec3 min_mm{}, max_mm{};

  Vec3 middle() const noexcept { return (min_mm + max_mm) * 0.5; }
  Vec3 size() const noexcept { return max_mm - min_mm; }
  /// Whether all edges are longer than zero. A device with an unknown workspace states an empty
  /// box.
  bool has_volume() const noexcept {
    const Vec3 edges = size();
    return edges.x > 0 && edges.y > 0 && edges.z > 0;
  }
};

/// The device's workspace in the block: a box that may be turned.
struct Reach {
  Vec3 center_mm{};
  /// Half of its edge lengths along the device's axes, mm in the block.
  Vec3 half_mm{};
  /// Rotation vector.
  Vec3 turn_rad{};
  double scale = 1;

  friend bool operator==(const Reach&, const Reach&) = default;
};

/// Maps points, motions and answers from one space to the other. Under the identity, values stay
/// the same to the bit.
class SpaceMap {
 public:
  SpaceMap() noexcept : SpaceMap(WorkspaceMapping{}) {}
  explicit SpaceMap(const WorkspaceMapping& mapping) noexcept;

  const WorkspaceMapping& mapping() const noexcept { return mapping_; }
  bool is_identity() const noexcept { return is_identity_; }

  Vec3 to_block(Vec3 device_mm) const noexcept;
  Vec3 to_device(Vec3 block_mm) const noexcept;
  /// For a direction: turned only.
  Vec3 turned_to_block(Vec3 v) const noexcept;
  Vec3 turned_to_device(Vec3 v) const noexcept;

  /// Returns the image of a grip in the block. The distance from its pivot to the tip is scaled.
  PastGrip to_block(const PastGrip& device) const noexcept;
  /// Returns a wrench in the block, about the image of the device's pivot, as the hand feels it.
  Wrench to_device(const Wrench& block) const noexcept;
  /// Returns an answer of the session in device space. Its torque is about the session's pivot,
  /// `pivot_mm` from the tip. That of the result is about the device's pivot, at the same distance
  /// in device space. `axis`: the device's axis at the answered pose.
  ServerWrench to_device(const ServerWrench& answer, Vec3 axis, double pivot_mm) const noexcept;

  /// Returns the mapping with `device_mm` moved to another point of the block.
  SpaceMap placed(Vec3 device_mm, Vec3 block_mm) const noexcept;
  Reach reach_of(const SpaceBox& workspace) const noexcept;

 private:
  WorkspaceMapping mapping_;
  bool is_identity_ = true;
  /// Rows of the rotation from device space to the block.
  std::array<Vec3, 3> rows_{};
};

/// Mapping requested by the user.
struct MappingChoice {
  double scale = 1;
  /// Fits the stock to the workspace, if that is known, and ignores `scale`.
  bool fits = false;
  double gain = 1;
  Vec3 turn_rad{};
};

/// Returns a mapping that shows the center of the workspace at the center of the stock, at the
/// least scale at which the stock fills at most kFilled of each edge of the workspace. Empty if the
/// workspace is unknown. `like`: gives gain and turn.
std::optional<WorkspaceMapping> fitted(const SpaceBox& stock, const SpaceBox& workspace,
                                       const WorkspaceMapping& like) noexcept;

/// Returns the mapping at the start. Without a fit the center of the workspace stays where the
/// driver placed it. An unknown workspace is centered on the top of the stock, as drivers place
/// theirs. A fit without a workspace has the scale 1.
WorkspaceMapping placed_mapping(const MappingChoice& choice, const SpaceBox& stock,
                                const SpaceBox& workspace) noexcept;

}  // namespace kerf::agent
