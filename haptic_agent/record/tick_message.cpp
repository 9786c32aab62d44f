// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/record/tick_message.h"

#include <initializer_list>

namespace kerf::agent {
namespace {

using mcap::ByteReader;
using mcap::Bytes;
using mcap::ByteWriter;

/// CDR, little-endian, without a parameter list.
constexpr std::uint32_t kCdrLittleEndian = 0x00000100;

constexpr const char* kSchema = R"(# One tick of the 1 kHz loop of kerf-agent.
# Forces in N, torques in N mm about the pivot, positions in mm; z up. As the hand feels it: in
# device space, which is the session's unless the metadata have a mapping.
# Start of the tick, and when the device measured the pose: microseconds of CLOCK_MONOTONIC.
uint64 time_us
uint64 pose_us
# Age of the newest answer of the server or the replica, as it fades forces; 0 before the first.
uint64 answer_age_us
# Level of the energy tank, and the share of the computed wrench that is felt, 0 to 1.
float64 energy_mj
float64 felt_share
# Tip of the tool, and its axis from the tip to the spindle (unit).
geometry_msgs/Vector3 tip_mm
geometry_msgs/Vector3 axis
# Computed by the session at this pose; requested from the output stage; written to the device.
geometry_msgs/Vector3 computed_force_n
geometry_msgs/Vector3 computed_torque_nmm
geometry_msgs/Vector3 requested_force_n
geometry_msgs/Vector3 requested_torque_nmm
geometry_msgs/Vector3 felt_force_n
geometry_msgs/Vector3 felt_torque_nmm
uint32 BUTTON_CUTTING=1
uint32 BUTTON_DEADMAN=2
uint32 buttons
uint32 tool_id
# Ticks that the loop lost since the previous one.
uint32 lost_ticks
uint8 PHASE_READY=0
uint8 PHASE_ARMED=1
uint8 PHASE_RAMP=2
uint8 PHASE_ACTIVE=3
uint8 PHASE_DEGRADED=4
uint8 PHASE_SAFE=5
uint8 phase
# The latest trip; 0: none yet.
uint8 TRIP_DEVICE_LOST=1
uint8 TRIP_POSE_NOT_FINITE=2
uint8 TRIP_OUT_OF_WORKSPACE=3
uint8 TRIP_POSE_JUMP=4
uint8 TRIP_TIP_TOO_FAST=5
uint8 TRIP_TURNS_TOO_FAST=6
uint8 TRIP_LOST_TICKS_IN_A_ROW=7
uint8 TRIP_LOST_TICKS=8
uint8 TRIP_FORCE_TOO_LONG=9
uint8 TRIP_TORQUE_TOO_LONG=10
uint8 TRIP_ENERGY_OVERDRAWN=11
uint8 TRIP_WRENCH_NOT_FINITE=12
uint8 trip
# How the force is rendered (--mode).
uint8 MODE_MODEL=0
uint8 MODE_INTERPOLATED=1
uint8 MODE_HOLD=2
uint8 MODE_PAPER=3
uint8 MODE_SILENT=4
uint8 mode
# False: the device had no usable pose; tip and axis are the last ones.
bool has_pose
================================================================================
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
)";

static_assert(kTripNames.size() == 13 && kPhaseNames.size() == 6,
              "the schema lists phases and trips");

Vec3 vector_of(ByteReader& from) {
  const auto x = from.number<double>();
  const auto y = from.number<double>();
  return {x, y, from.number<double>()};
}

Wrench wrench_of(ByteReader& from) {
  const Vec3 force = vector_of(from);
  return {force, vector_of(from)};
}

}  // namespace

const mcap::ChannelType& tick_channel() {
  static const mcap::ChannelType kChannel{.topic = "/haptic",
                                          .message_encoding = "cdr",
                                          .schema_name = "kerf_msgs/msg/HapticTick",
                                          .schema_encoding = "ros2msg",
                                          .schema = kSchema};
  return kChannel;
}

// CDR aligns each number to its size, counted from the end of its head. The fields are ordered from
// the widest to the narrowest, so there is no padding.
void append_tick(Bytes& out, const TickRecord& t) {
  ByteWriter to(out);
  to.number(kCdrLittleEndian);
  for (const std::uint64_t value : {t.time_us, t.pose_us, t.answer_age_us}) to.number(value);
  for (const double value : {t.energy_mj, t.felt_share}) to.number(value);
  for (const Vec3& v :
       {t.tip_mm, t.axis, t.computed.force_n, t.computed.torque_nmm, t.requested.force_n,
        t.requested.torque_nmm, t.felt.force_n, t.felt.torque_nmm}) {
    for (const double value : {v.x, v.y, v.z}) to.number(value);
  }
  for (const std::uint32_t value : {t.buttons, t.tool_id, t.lost}) to.number(value);
  to.number(static_cast<std::uint8_t>(t.phase));
  to.number(static_cast<std::uint8_t>(t.trip));
  to.number(static_cast<std::uint8_t>(t.mode));
  to.number(static_cast<std::uint8_t>(t.has_pose));
}

std::optional<TickRecord> tick_of(std::span<const std::byte> message) {
  ByteReader from(message);
  if (from.number<std::uint32_t>() != kCdrLittleEndian) return std::nullopt;
  TickRecord t;
  for (std::uint64_t* value : {&t.time_us, &t.pose_us, &t.answer_age_us}) {
    *value = from.number<std::uint64_t>();
  }
  t.energy_mj = from.number<double>();
  t.felt_share = from.number<double>();
  t.tip_mm = vector_of(from);
  t.axis = vector_of(from);
  for (Wrench* wrench : {&t.computed, &t.requested, &t.felt}) *wrench = wrench_of(from);
  for (std::uint32_t* value : {&t.buttons, &t.tool_id, &t.lost}) {
    *value = from.number<std::uint32_t>();
  }
  const auto phase = from.number<std::uint8_t>();
  const auto trip = from.number<std::uint8_t>();
  const auto mode = from.number<std::uint8_t>();
  t.has_pose = from.number<std::uint8_t>() != 0;
  if (!from.good() || phase >= kPhaseNames.size() || trip >= kTripNames.size() ||
      mode > static_cast<std::uint8_t>(ForceMode::kSilent)) {
    return std::nullopt;
  }
  t.phase = static_cast<ServoPhase>(phase);
  t.trip = static_cast<TripCode>(trip);
  t.mode = static_cast<ForceMode>(mode);
  return t;
}

}  // namespace kerf::agent
