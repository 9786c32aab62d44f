#include "server/session/convert.h"

#include <algorithm>
#include <cmath>

#include "server/formats/pose_grid.h"
#include "server/session/participant.h"
#include "server/wire/limits.h"

namespace kerf {

const char* to_string(ParticipantKind kind) {
  switch (kind) {
    case ParticipantKind::kAgent:
      return wire::kKindAgent.data();
    case ParticipantKind::kProgram:
      return wire::kKindProgram.data();
    case ParticipantKind::kViewer:
      return wire::kKindViewer.data();
  }
  return wire::kKindViewer.data();
}

Refusal to_refusal(const SculptureError& error) {
  using enum SculptureErrorCode;
  switch (error.code) {
    case kTurnTooLarge:
      return {wire::ErrorCode::kTurnTooLarge, error.reason};
    case kUnknownTool:
      return {wire::ErrorCode::kUnknownTool, error.reason};
    case kNotFinite:
    case kBadAxis:
    case kOutOfRange:
      return {wire::ErrorCode::kBadPose, error.reason};
    default:
      return {wire::ErrorCode::kMotionRefused, error.reason};
  }
}

std::expected<ToolPose, Refusal> to_pose(const wire::MotionSample& sample) {
  const auto refuse = [&](const char* what) {
    return std::unexpected(
        Refusal{wire::ErrorCode::kBadPose,
                "sample " + std::to_string(sample.agent_sequence) + ": " + what});
  };
  ToolPose pose;
  pose.tip_mm = {sample.tip_mm[0], sample.tip_mm[1], sample.tip_mm[2]};
  pose.axis = {static_cast<double>(sample.axis[0]), static_cast<double>(sample.axis[1]),
               static_cast<double>(sample.axis[2])};
  if (!is_finite(pose.tip_mm)) return refuse("the tip is not finite");
  if (!is_finite(pose.axis)) return refuse("the axis is not finite");
  for (const double coordinate : sample.tip_mm) {
    if (std::abs(coordinate) > kCoordinateMaxMm) return refuse("the tip is out of range");
  }
  if (std::abs(length(pose.axis) - 1) > wire::kAxisLengthTolerance) {
    return refuse("the axis is not of unit length");
  }
  return admit_pose(pose);
}

wire::Vec3f to_wire_float(Vec3 value) {
  return {static_cast<float>(value.x), static_cast<float>(value.y), static_cast<float>(value.z)};
}
wire::Vec3d to_wire(Vec3 value) { return {value.x, value.y, value.z}; }

void BatchSum::add(const MotionResult& result, double duration_s) {
  impulse_.force_n = impulse_.force_n + result.wrench.force_n * duration_s;
  impulse_.torque_nmm = impulse_.torque_nmm + result.wrench.torque_nmm * duration_s;
  collision_impulse_.force_n = collision_impulse_.force_n + result.collision.force_n * duration_s;
  // A tick may remove nothing and yet be engaged: a wall parallel to the rays is felt between two
  // columns, and so is the cut in which the tool rests.
  if (result.cutting.engaged_area_mm2 > 0) {
    const Vec3 cut_n = result.wrench.force_n - result.collision.force_n;
    last_specific_ = length(cut_n) / result.cutting.engaged_area_mm2;
  }
  if (result.cutting.engaged_area_mm2 > 0 || result.removed_mm3 > 0) cutting_ = result.cutting;
  removed_mm3_ += result.removed_mm3;
  duration_s_ += duration_s;
  ++motions_;
}

void BatchSum::touch(std::span<const ContactPlane> planes) {
  planes_count_ = 0;
  for (const ContactPlane& plane : planes.first(std::min(planes.size(), planes_.size()))) {
    planes_[planes_count_++] = {
        .point_mm = to_wire(plane.point_mm),
        .normal = to_wire_float(plane.normal),
        .depth_mm = static_cast<float>(plane.depth_mm),
        .stiffness_n_per_mm = static_cast<float>(plane.stiffness_n_per_mm),
        .radius_mm = static_cast<float>(plane.radius_mm),
        .flags = plane.stock ? wire::kContactStock : wire::kContactObstacle};
  }
}

void BatchSum::write(wire::Result& result) const {
  result.plane_count = planes_count_;
  result.planes = planes_;
  if (empty() || duration_s_ <= 0) return;
  const double scale = 1 / duration_s_;
  result.force_n = to_wire_float(impulse_.force_n * scale);
  result.torque_nmm = to_wire_float(impulse_.torque_nmm * scale);
  result.collision_force_n = to_wire_float(collision_impulse_.force_n * scale);
  result.engaged_area_mm2 = static_cast<float>(cutting_.engaged_area_mm2);
  result.direction = to_wire_float(cutting_.direction);
  result.cut_centre_mm = to_wire(cutting_.center_mm);
  result.specific_force_n_per_mm2 = static_cast<float>(last_specific_);
  result.removed_mm3 = static_cast<float>(removed_mm3_);
  if (removed_mm3_ > 0) result.status |= wire::kStatusCutting;
  if (length(collision_impulse_.force_n) > 0) result.status |= wire::kStatusColliding;
}

}  // namespace kerf
