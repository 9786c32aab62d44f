// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "kernel/math/vec3.h"
#include "server/wire/frame.h"
#include "server/wire/limits.h"

namespace kerf::wire {

/// Bits of MotionSample::buttons.
inline constexpr std::uint32_t kButtonCutting = 1;
inline constexpr std::uint32_t kButtonDeadman = 2;

/// Bits of Result::status and ToolState::status.
inline constexpr std::uint32_t kStatusCutting = 1;
inline constexpr std::uint32_t kStatusColliding = 2;
inline constexpr std::uint32_t kStatusRejected = 4;
/// Of a result over UDP: samples are missing between this one and those that came.
inline constexpr std::uint32_t kStatusGap = 8;

/// One pose of a tool. The motion that it stands for runs from the sample before it to this one;
/// without kButtonCutting that motion goes through the air.
struct MotionSample {
  /// From 1, consecutive; a repeated number is a repetition and is skipped by the server.
  std::uint64_t agent_sequence = 0;
  /// The agent's monotonic clock when the pose was read.
  std::uint64_t time_us = 0;
  Vec3 tip_mm{};
  /// From the tip to the spindle, unit length to kAxisLengthTolerance.
  Vec3f axis{0.0F, 0.0F, 1.0F};
  std::uint32_t tool_id = 0;
  std::uint32_t buttons = 0;

  bool operator==(const MotionSample&) const = default;
};

/// Up to kMaxSamplesPerMotion samples with consecutive numbers; only the first `count` are sent.
struct MotionBatch {
  std::uint32_t count = 0;
  std::array<MotionSample, kMaxSamplesPerMotion> samples{};

  std::span<const MotionSample> view() const noexcept { return {samples.data(), count}; }
  bool operator==(const MotionBatch&) const = default;
};

/// Bits of ContactPlane::flags: what the tool touches or is about to touch.
inline constexpr std::uint32_t kContactObstacle = 1;
inline constexpr std::uint32_t kContactStock = 2;

/// The surface of something that pushes the tool, near one place of the tool, as a plane (Adachi's
/// intermediate representation): what an agent needs to render the contact between two results.
struct ContactPlane {
  /// The place of the tool that is deepest, where the answered sample put it.
  Vec3 point_mm{};
  /// Unit, out of the surface: the way in which it pushes.
  Vec3f normal{};
  /// How far that place is beyond the surface; below zero: a gap that is still open.
  float depth_mm = 0.0F;
  /// Force per depth.
  float stiffness_n_per_mm = 0.0F;
  /// Farther from `point_mm` than this the plane says nothing.
  float radius_mm = 0.0F;
  std::uint32_t flags = 0;

  bool operator==(const ContactPlane&) const = default;
};

/// The server's answer to the newest sample that it applied, with the local cutting model:
/// engaged area, feed direction, centre and specific force, from which force can be rendered
/// locally. Collision force and planes say the same: the force is that of the planes whose depth is
/// above zero.
struct Result {
  std::uint64_t agent_sequence = 0;
  std::uint64_t agent_time_us = 0;
  std::uint64_t motions_applied = 0;
  Vec3f force_n{};
  /// About the pivot.
  Vec3f torque_nmm{};
  float engaged_area_mm2 = 0.0F;
  Vec3f direction{};
  Vec3 cut_centre_mm{};
  float specific_force_n_per_mm2 = 0.0F;
  float removed_mm3 = 0.0F;
  std::uint32_t status = 0;
  Vec3f collision_force_n{};
  std::uint32_t turnaround_us = 0;
  /// Only the first `plane_count` are sent.
  std::uint32_t plane_count = 0;
  std::array<ContactPlane, kMaxContactPlanes> planes{};

  std::span<const ContactPlane> contact() const noexcept { return {planes.data(), plane_count}; }
  bool operator==(const Result&) const = default;
};

/// Where one participant's tool is and what it feels, for the viewers.
struct ToolState {
  std::uint32_t participant = 0;
  std::uint32_t tool_id = 0;
  Vec3 tip_mm{};
  Vec3f axis{0.0F, 0.0F, 1.0F};
  std::uint32_t status = 0;
  Vec3f force_n{};
  Vec3f torque_nmm{};
  float removed_rate_mm3_per_s = 0.0F;

  bool operator==(const ToolState&) const = default;
};

struct ToolStates {
  std::vector<ToolState> tools;
  bool operator==(const ToolStates&) const = default;
};

/// A GLB; the bytes belong to the frame that was decoded and live as long as it does.
struct MeshView {
  std::span<const std::byte> glb;
};

/// What one tile of the block still holds, at most: an agent's copy keeps what both have. The bytes
/// belong to the frame that was decoded and live as long as it does.
struct StockTile {
  /// Of the rays: 0 for X, 1 for Y, 2 for Z.
  std::uint32_t axis = 2;
  std::uint32_t x = 0, y = 0;
  /// Columns as README.md says; none: nothing more than what is known of the tile already.
  std::span<const std::byte> columns;
};

/// Tiles near an agent's tool.
struct StockPatch {
  /// Forget what came before: the block is as the welcome said, less what follows.
  bool reset = false;
  /// Samples of this agent up to here, by its clock, are cut out of them or were rejected; 0: none.
  std::uint64_t agent_time_us = 0;
  std::vector<StockTile> tiles;
};

struct Ack {
  bool operator==(const Ack&) const = default;
};

struct Ping {
  std::uint64_t time_us = 0;
  bool operator==(const Ping&) const = default;
};

struct Pong {
  std::uint64_t ping_time_us = 0;
  std::uint64_t time_us = 0;
  bool operator==(const Pong&) const = default;
};

/// A well-formed frame of a type that this version does not know: to be skipped.
struct UnknownBody {
  bool operator==(const UnknownBody&) const = default;
};

struct Message {
  FrameHeader header;
  std::variant<MotionBatch, Result, MeshView, ToolStates, Ack, Ping, Pong, StockPatch, UnknownBody>
      body;
};

}  // namespace kerf::wire
