#include "kernel/force/cutting_force.h"

#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

/// Which way each removed dexel pushes the tool (paper Fig. 12).
class ForceDirection {
 public:
  explicit ForceDirection(const ToolMotion& motion) : pose_(motion.at(0.5)) {
    const Vec3 travel = motion.to.tip_mm - motion.from.tip_mm;
    switch (motion.kind) {
      case MotionKind::kAxial:  // Eq. 20: along the axis, against the way taken.
        common_ = dot(travel, pose_.axis) < 0 ? pose_.axis : -pose_.axis;
        break;
      case MotionKind::kRotation:  // Eq. 21: against each point's way around the tip.
        turn_ = cross(motion.from.axis, motion.to.axis);
        break;
      default:  // Eq. 22: against the way of the tip.
        common_ = -normalized(travel);
    }
  }

  /// Zero for a point on the axis of the turn, which does not move (the degenerate case of Eq. 21).
  Vec3 at(Vec3 point_mm) const {
    if (turn_ == Vec3{}) return common_;
    return -normalized(cross(turn_, point_mm - pose_.tip_mm));
  }
  const ToolPose& pose() const { return pose_; }

 private:
  ToolPose pose_;
  Vec3 common_;
  Vec3 turn_;
};

}  // namespace

CuttingForce::CuttingForce(const ForceSettings& settings, double duration_s, int fields)
    : settings_(settings), duration_s_(duration_s), weight_(1.0 / fields) {}

void CuttingForce::add(const DexelGrid& grid, const Removal& removal, const ToolMotion& motion,
                       double share) {
  if (removal.quanta == 0) return;
  const ForceDirection direction(motion);
  const Vec3 pivot = direction.pose().tip_mm + direction.pose().axis * settings_.pivot_mm;
  const double quantum_mm3 = grid.z_quantum_mm * grid.pitch_mm * grid.pitch_mm;
  // Sums of dV_i f_dir, of (P_i − P_pivot) × dV_i f_dir (Eqs. 23, 24; the sign of Eq. 19), and of
  // dV_i P_i.
  Vec3 push, turn, moment;
  for (const RemovedGroup& g : removal.groups) {
    for (int c = 0; c < RemovedGroup::kLanes; ++c) {
      if (g.bottom[c] == g.top[c]) continue;
      const double middle = (double(g.bottom[c]) + double(g.top[c])) / 2;
      const Vec3 p{grid.x_mm(g.i + c), grid.y_mm(g.j),
                   grid.origin_mm.z + middle * grid.z_quantum_mm};
      const double volume = (g.top[c] - g.bottom[c]) * quantum_mm3;
      const Vec3 f = direction.at(p) * volume;
      push = push + f;
      turn = turn + cross(p - pivot, f);
      moment = moment + p * volume;
    }
  }
  const double volume_mm3 = static_cast<double>(removal.quanta) * quantum_mm3;
  volume_mm3_ += weight_ * volume_mm3;
  moment_ = moment_ + from_frame(grid.axis, moment) * weight_;

  // The path of the contact: how far the tool's material moved where it cut.
  const Vec3 center = moment * (1 / volume_mm3);
  const Vec3 chord = cross(motion.from.axis, motion.to.axis);
  const Vec3 way =
      motion.to.tip_mm - motion.from.tip_mm + cross(chord, center - direction.pose().tip_mm);
  const double path_mm = length(way);
  if (path_mm > kRestEpsilonMm) area_mm2_ += weight_ * share * volume_mm3 / path_mm;

  double scale =
      0;  // N per mm^3 removed in this sub-motion, as its part of the mean over the motion
  if (settings_.law == ForceLaw::kDexelRemovalRate) {
    scale = settings_.drr_n_s_per_mm3 / duration_s_;
  } else if (path_mm > kRestEpsilonMm) {
    scale = settings_.specific_force_n_per_mm2 * share / path_mm;
  }
  const Vec3 axis = direction.pose().axis;
  Vec3 torque = turn * scale;
  torque = torque - axis * dot(torque, axis);  // A 5-DOF device cannot twist the pen about itself.
  sum_ = sum_ + Wrench{from_frame(grid.axis, push * (scale * weight_)),
                       from_frame(grid.axis, torque * weight_)};
}

}  // namespace kerf
