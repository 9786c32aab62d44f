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
/// MotionSample::felt_share is stated.
inline constexpr std::uint32_t kButtonFelt = 4;

/// Bits of Result::status and ToolState::status.
inline constexpr std::uint32_t kStatusCutting = 1;
inline constexpr std::uint32_t kStatusColliding = 2;
inline constexpr std::uint32_t kStatusRejected = 4;
/// Only in results over UDP: samples are missing before those received.
inline constexpr std::uint32_t kStatusGap = 8;
/// Part of the removed volume was inside the tool at the start of a motion, and gives no force.
inline constexpr std::uint32_t kStatusImprint = 16;
/// Only in tool states: ToolState::felt_share is stated.
inline constexpr std::uint32_t kStatusFelt = 32;

/// One pose of a tool, which represents the motion from the previous sample to this one. Without
/// kButtonCutting the motion does not cut.
struct MotionSample {
  /// From 1, consecutive. The server skips samples with a number that it has received.
  std::uint64_t agent_sequence = 0;
  /// The agent's monotonic clock when the pose was read.
  std::uint64_t time_us = 0;
  Vec3 tip_mm{};
  /// From the tip to the spindle, unit length to kAxisLengthTolerance.
  Vec3f axis{0.0F, 0.0F, 1.0F};
  std::uint32_t tool_id = 0;
  std::uint32_t buttons = 0;
  /// With kButtonFelt: the share of the computed wrench, 0 to 1, that the device output when the
  /// pose was read. Zero otherwise.
  float felt_share = 0.0F;

  bool operator==(const MotionSample&) const = default;
};

/// Up to kMaxSamplesPerMotion samples with consecutive numbers. Only the first `count` are sent.
struct MotionBatch {
  std::uint32_t count = 0;
  std::array<MotionSample, kMaxSamplesPerMotion> samples{};

  std::span<const MotionSample> view() const noexcept { return {samples.data(), count}; }
  bool operator==(const MotionBatch&) const = default;
};

/// Bits of ContactPlane::flags: the kind of surface.
inline constexpr std::uint32_t kContactObstacle = 1;
inline constexpr std::uint32_t kContactStock = 2;
/// Another point of the contact of the previous plane, along a line or over an area.
inline constexpr std::uint32_t kContactContinues = 4;

/// Plane approximation of a surface near one point of the tool (Adachi's intermediate
/// representation), from which an agent renders the contact between two results. A contact at one
/// point is one plane. One along a line or over an area is two or three, whose points surround its
/// center of pressure and average to it. They have equal normals and depths, and equal shares of
/// the contact's stiffness, so that their pushes add up to that of the contact.
struct ContactPlane {
  /// At the pose of the answered sample. For a contact at one point the center of pressure: the
  /// mean over the area of contact, weighted by the square of the depth. For a gap the tool's
  /// nearest point.
  Vec3 point_mm{};
  /// Unit vector out of the surface: the direction of the contact force.
  Vec3f normal{};
  /// Penetration at the deepest point of the contact, which may differ from `point_mm` (negative:
  /// width of the gap).
  float depth_mm = 0.0F;
  /// Contact force per depth.
  float stiffness_n_per_mm = 0.0F;
  /// The plane is valid within this distance of `point_mm`.
  float radius_mm = 0.0F;
  std::uint32_t flags = 0;

  bool operator==(const ContactPlane&) const = default;
};

/// The result of a batch of samples, with the local cutting model (engaged area, feed direction,
/// center and specific force), from which an agent can render force locally. The collision force is
/// the sum over the planes with positive depth.
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
  /// The samples of the agent up to this number are on the server's disk, or need not be. 0: not
  /// stated.
  std::uint64_t durable_sequence = 0;

  std::span<const ContactPlane> contact() const noexcept { return {planes.data(), plane_count}; }
  bool operator==(const Result&) const = default;
};

/// Pose and force of one participant's tool, for display by viewers.
struct ToolState {
  std::uint32_t participant = 0;
  std::uint32_t tool_id = 0;
  Vec3 tip_mm{};
  Vec3f axis{0.0F, 0.0F, 1.0F};
  std::uint32_t status = 0;
  Vec3f force_n{};
  Vec3f torque_nmm{};
  float removed_rate_mm3_per_s = 0.0F;
  /// With kStatusFelt: the share of force and torque, 0 to 1, that the participant's device
  /// outputs. Zero otherwise.
  float felt_share = 0.0F;

  bool operator==(const ToolState&) const = default;
};

struct ToolStates {
  std::vector<ToolState> tools;
  bool operator==(const ToolStates&) const = default;
};

/// A GLB. After decoding, the bytes belong to the decoded frame.
struct MeshView {
  std::span<const std::byte> glb;
};

/// The remaining material of one tile, with which an agent intersects its replica. After decoding,
/// the bytes belong to the decoded frame.
struct StockTile {
  /// Axis of the rays: 0 for X, 1 for Y, 2 for Z.
  std::uint32_t axis = 2;
  std::uint32_t x = 0, y = 0;
  /// Columns, encoded as specified in README.md (empty: unchanged).
  std::span<const std::byte> columns;
};

/// Tiles near an agent's tool.
struct StockPatch {
  /// Discard all earlier patches and start from the stock of the welcome.
  bool reset = false;
  /// Stock may have come back to these tiles: start each over from the stock of the welcome. One
  /// without columns is unknown from then on.
  bool returned = false;
  /// Samples of this agent up to this time of its clock are cut from the tiles, or rejected; 0
  /// before the first.
  std::uint64_t agent_time_us = 0;
  std::vector<StockTile> tiles;
};

/// A pose of another participant's tool near the agent's. It is sent ahead of the stock frames with
/// its cuts.
struct Intent {
  std::uint32_t participant = 0;
  std::uint32_t tool_id = 0;
  /// The author's clock at the pose. Only differences are meaningful.
  std::uint64_t time_us = 0;
  /// `time_us` of the newest sample that the server had from the receiver when it had this pose.
  std::uint64_t agent_time_us = 0;
  Vec3 tip_mm{};
  Vec3f axis{0.0F, 0.0F, 1.0F};
  /// kStatusCutting: the motion to this pose cut. Other bits are zero.
  std::uint32_t status = 0;

  bool operator==(const Intent&) const = default;
};

/// The tools near an agent's. Tools that are not listed are no longer near. Only the first `count`
/// are sent.
struct Intents {
  std::uint32_t count = 0;
  std::array<Intent, kMaxIntents> tools{};

  std::span<const Intent> view() const noexcept { return {tools.data(), count}; }
  bool operator==(const Intents&) const = default;
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
  /// To an agent as in a result; to a viewer that verifies, the sequence of the last mesh frame
  /// sent before.
  std::uint64_t durable_sequence = 0;
  bool operator==(const Pong&) const = default;
};

/// A well-formed frame of an unknown type, to be skipped.
struct UnknownBody {
  bool operator==(const UnknownBody&) const = default;
};

struct Message {
  FrameHeader header;
  std::variant<MotionBatch, Result, MeshView, ToolStates, Ack, Ping, Pong, StockPatch, Intents,
               UnknownBody>
      body;
};

}  // namespace kerf::wire
