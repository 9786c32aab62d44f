// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/mapping/workspace_mapping.h"

#include <algorithm>
#include <cmath>

namespace kerf::agent {
namespace {

/// Share of the workspace that the stock fills in `fitted`.
constexpr double kFilled = 0.8;

bool changes_nothing(const WorkspaceMapping& mapping) noexcept {
  return mapping.scale == 1 && mapping.gain == 1 && mapping.turn_rad == Vec3{} &&
         mapping.device_mm == mapping.block_mm;
}

}  // namespace

SpaceMap::SpaceMap(const WorkspaceMapping& mapping) noexcept
    : mapping_(mapping), is_identity_(changes_nothing(mapping)) {
  const Vec3 x = rotated({1, 0, 0}, mapping.turn_rad), y = rotated({0, 1, 0}, mapping.turn_rad),
             z = rotated({0, 0, 1}, mapping.turn_rad);
  rows_ = {Vec3{x.x, y.x, z.x}, Vec3{x.y, y.y, z.y}, Vec3{x.z, y.z, z.z}};
}

Vec3 SpaceMap::turned_to_block(Vec3 v) const noexcept {
  if (is_identity_) return v;
  return {dot(rows_[0], v), dot(rows_[1], v), dot(rows_[2], v)};
}

Vec3 SpaceMap::turned_to_device(Vec3 v) const noexcept {
  if (is_identity_) return v;
  return rows_[0] * v.x + rows_[1] * v.y + rows_[2] * v.z;
}

Vec3 SpaceMap::to_block(Vec3 device_mm) const noexcept {
  if (is_identity_) return device_mm;
  return mapping_.block_mm + turned_to_block(device_mm - mapping_.device_mm) * mapping_.scale;
}

Vec3 SpaceMap::to_device(Vec3 block_mm) const noexcept {
  if (is_identity_) return block_mm;
  return mapping_.device_mm + turned_to_device(block_mm - mapping_.block_mm) * (1 / mapping_.scale);
}

PastGrip SpaceMap::to_block(const PastGrip& device) const noexcept {
  if (is_identity_) return device;
  return {.time_us = device.time_us,
          .grip = {to_block(device.grip.pivot_mm), turned_to_block(device.grip.axis)},
          .velocity = {turned_to_block(device.velocity.linear) * mapping_.scale,
                       turned_to_block(device.velocity.angular)},
          .path_mm = device.path_mm * mapping_.scale,
          .heading = turned_to_block(device.heading)};
}

Wrench SpaceMap::to_device(const Wrench& block) const noexcept {
  if (is_identity_) return block;
  return {turned_to_device(block.force_n) * mapping_.gain,
          turned_to_device(block.torque_nmm) * mapping_.torque_gain()};
}

ServerWrench SpaceMap::to_device(const ServerWrench& answer, Vec3 axis,
                                 double pivot_mm) const noexcept {
  if (is_identity_) return answer;
  ServerWrench mapped = answer;
  mapped.wrench = to_device(answer.wrench);
  // From the session's pivot to the image of the device's, in units of the device.
  const double nearer_mm = pivot_mm * (1 / mapping_.scale - 1);
  mapped.wrench.torque_nmm =
      mapped.wrench.torque_nmm + cross(axis * nearer_mm, mapped.wrench.force_n);
  // In device space, the other participant's hand has a lever as long as this one's.
  mapped.felt = {turned_to_device(answer.felt.force_n) * mapping_.gain,
                 turned_to_device(answer.felt.torque_nmm) * mapping_.gain};
  mapped.cut_centre_mm = to_device(answer.cut_centre_mm);
  for (std::uint32_t i = 0; i < answer.plane_count; ++i) {
    wire::ContactPlane& plane = mapped.planes[i];
    plane.point_mm = to_device(plane.point_mm);
    plane.normal = Vec3f(turned_to_device(Vec3(plane.normal)));
    plane.depth_mm = static_cast<float>(static_cast<double>(plane.depth_mm) / mapping_.scale);
    plane.radius_mm = static_cast<float>(static_cast<double>(plane.radius_mm) / mapping_.scale);
    plane.stiffness_n_per_mm = static_cast<float>(static_cast<double>(plane.stiffness_n_per_mm) *
                                                  mapping_.stiffness_scale());
  }
  return mapped;
}

SpaceMap SpaceMap::placed(Vec3 device_mm, Vec3 block_mm) const noexcept {
  SpaceMap moved = *this;
  moved.mapping_.device_mm = device_mm;
  moved.mapping_.block_mm = block_mm;
  moved.is_identity_ = changes_nothing(moved.mapping_);
  return moved;
}

Reach SpaceMap::reach_of(const SpaceBox& workspace) const noexcept {
  return {.center_mm = to_block(workspace.middle()),
          .half_mm = workspace.size() * (mapping_.scale / 2),
          .turn_rad = mapping_.turn_rad,
          .scale = mapping_.scale};
}

std::optional<WorkspaceMapping> fitted(const SpaceBox& stock, const SpaceBox& workspace,
                                       const WorkspaceMapping& like) noexcept {
  if (!workspace.has_volume()) return std::nullopt;
  const SpaceMap turn({.turn_rad = like.turn_rad});
  const Vec3 half = stock.size() * 0.5;
  // Extents of the stock along the axes of the device: for a turned box, the sum over its edges.
  Vec3 extent{};
  for (const Vec3 edge : {Vec3{half.x, 0, 0}, Vec3{0, half.y, 0}, Vec3{0, 0, half.z}}) {
    const Vec3 along = turn.turned_to_device(edge);
    extent = extent + Vec3{std::abs(along.x), std::abs(along.y), std::abs(along.z)};
  }
  const Vec3 reach = workspace.size() * (kFilled / 2);
  WorkspaceMapping fit = like;
  fit.scale = std::clamp(std::max({extent.x / reach.x, extent.y / reach.y, extent.z / reach.z}),
                         kScaleMin, kScaleMax);
  fit.device_mm = workspace.middle();
  fit.block_mm = stock.middle();
  return fit;
}

WorkspaceMapping placed_mapping(const MappingChoice& choice, const SpaceBox& stock,
                                const SpaceBox& workspace) noexcept {
  const Vec3 middle = stock.middle();
  const Vec3 fixed =
      workspace.has_volume() ? workspace.middle() : Vec3{middle.x, middle.y, stock.max_mm.z};
  const WorkspaceMapping like{.scale = choice.fits ? 1 : choice.scale,
                              .gain = choice.gain,
                              .turn_rad = choice.turn_rad,
                              .device_mm = fixed,
                              .block_mm = fixed};
  return choice.fits ? fitted(stock, workspace, like).value_or(like) : like;
}

}  // namespace kerf::agent
