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

/// How the space of a device lies in that of the block: a similarity, which keeps angles
/// (derivation in README.md).
struct WorkspaceMapping {
  /// Millimeters in the block per millimeter of the device, kScaleMin to kScaleMax.
  double scale = 1;
  /// Force at the hand per force in the block, kGainMin to kGainMax.
  double gain = 1;
  /// Rotation vector, rad: device space is turned by it against the block.
  Vec3 turn_rad{};
  /// This point of device space ...
  Vec3 device_mm{};
  /// ... is at this point of the block.
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
  /// one.
  bool has_volume() const noexcept {
    const Vec3 edges = size();
    return edges.x > 0 && edges.y > 0 && edges.z > 0;
  }
};

/// Where a device's workspace is in the block: a box that may be turned.
struct Reach {
  Vec3 center_mm{};
  /// Half of its edges along the device's axes, mm in the block.
  Vec3 half_mm{};
  /// Rotation vector.
  Vec3 turn_rad{};
  double scale = 1;

  friend bool operator==(const Reach&, const Reach&) = default;
};

/// Carries points, motions and answers from one space to the other. Where the mapping changes
/// nothing, values stay the same to the bit.
class SpaceMap {
 public:
  SpaceMap() noexcept : SpaceMap(WorkspaceMapping{}) {}
  explicit SpaceMap(const WorkspaceMapping& mapping) noexcept;

  const WorkspaceMapping& mapping() const noexcept { return mapping_; }
  bool is_identity() const noexcept { return is_identity_; }

  Vec3 to_block(Vec3 device_mm) const noexcept;
  Vec3 to_device(Vec3 block_mm) const noexcept;
  /// Of a direction: turned only.
  Vec3 turned_to_block(Vec3 v) const noexcept;
  Vec3 turned_to_device(Vec3 v) const noexcept;

  /// Returns the image of a grip in the block. Its pivot is nearer to the tip than the session's by
  /// the scale.
  PastGrip to_block(const PastGrip& device) const noexcept;
  /// Returns a wrench in the block about the image of the device's pivot, as the hand feels it.
  Wrench to_device(const Wrench& block) const noexcept;
  /// Returns an answer of the session in device space. Its torque refers to the session's pivot,
  /// `pivot_mm` from the tip; the result's, to the device's, as far from the tip in device space.
  /// `axis`: of the device at the answered pose.
  ServerWrench to_device(const ServerWrench& answer, Vec3 axis, double pivot_mm) const noexcept;

  /// Returns the mapping with another point of the block at `device_mm`.
  SpaceMap placed(Vec3 device_mm, Vec3 block_mm) const noexcept;
  Reach reach_of(const SpaceBox& workspace) const noexcept;

 private:
  WorkspaceMapping mapping_;
  bool is_identity_ = true;
  /// Rows of the rotation from device space to the block.
  std::array<Vec3, 3> rows_{};
};

/// A request of the user.
struct MappingChoice {
  double scale = 1;
  /// Fit the stock to the workspace, if that is known, in place of `scale`.
  bool fits = false;
  double gain = 1;
  Vec3 turn_rad{};
};

/// Returns a mapping that shows the middle of the workspace at the middle of the stock, at the
/// least scale at which the workspace reaches all of the stock and a tenth of the workspace's edges
/// beyond on each side; nothing if the workspace is unknown. `like`: gain and turn.
std::optional<WorkspaceMapping> fitted(const SpaceBox& stock, const SpaceBox& workspace,
                                       const WorkspaceMapping& like) noexcept;

/// Returns the mapping at the start. Without a fit the middle of the workspace stays where the
/// device has placed it; of an unknown workspace, the middle of the stock's top, on which devices
/// place theirs. A fit without a workspace has the scale 1.
WorkspaceMapping placed_mapping(const MappingChoice& choice, const SpaceBox& stock,
                                const SpaceBox& workspace) noexcept;

}  // namespace kerf::agent
