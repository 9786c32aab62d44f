// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <type_traits>

#include "server/wire/bytes.h"
#include "server/wire/types.h"

namespace kerf::wire {

/// The order of the fields of each struct. ByteWriter and ByteReader share these functions, so that
/// encoder and decoder agree.

template <typename Struct, typename Plain>
concept MaybeConst = std::same_as<std::remove_const_t<Struct>, Plain>;

/// The header after magic and type, which need a conversion.
template <typename Io, MaybeConst<FrameHeader> Header>
void walk(Io& io, Header& header) noexcept {
  io.field(header.flags);
  io.field(header.header_bytes);
  io.field(header.payload_bytes);
  io.field(header.stamp.epoch);
  io.field(header.stamp.sequence);
  io.field(header.stamp.time_us);
}

template <typename Io, MaybeConst<MotionSample> Sample>
void walk(Io& io, Sample& sample) noexcept {
  io.field(sample.agent_sequence);
  io.field(sample.time_us);
  io.field(sample.tip_mm);
  io.field(sample.axis);
  io.field(sample.tool_id);
  io.field(sample.buttons);
  io.field(sample.felt_share);
}

template <typename Io, MaybeConst<Result> R>
void walk(Io& io, R& result) noexcept {
  io.field(result.agent_sequence);
  io.field(result.agent_time_us);
  io.field(result.motions_applied);
  io.field(result.force_n);
  io.field(result.torque_nmm);
  io.field(result.engaged_area_mm2);
  io.field(result.direction);
  io.field(result.cut_centre_mm);
  io.field(result.specific_force_n_per_mm2);
  io.field(result.removed_mm3);
  io.field(result.status);
  io.field(result.plane_count);
  io.field(result.collision_force_n);
  io.field(result.turnaround_us);
}

template <typename Io, MaybeConst<ContactPlane> Plane>
void walk(Io& io, Plane& plane) noexcept {
  io.field(plane.point_mm);
  io.field(plane.normal);
  io.field(plane.depth_mm);
  io.field(plane.stiffness_n_per_mm);
  io.field(plane.radius_mm);
  io.field(plane.flags);
  io.reserved();
}

template <typename Io, MaybeConst<ToolState> State>
void walk(Io& io, State& state) noexcept {
  io.field(state.participant);
  io.field(state.tool_id);
  io.field(state.tip_mm);
  io.field(state.axis);
  io.field(state.status);
  io.field(state.force_n);
  io.field(state.torque_nmm);
  io.field(state.removed_rate_mm3_per_s);
  io.field(state.felt_share);
}

template <typename Io, MaybeConst<Intent> I>
void walk(Io& io, I& intent) noexcept {
  io.field(intent.participant);
  io.field(intent.tool_id);
  io.field(intent.time_us);
  io.field(intent.agent_time_us);
  io.field(intent.tip_mm);
  io.field(intent.axis);
  io.field(intent.status);
}

}  // namespace kerf::wire
