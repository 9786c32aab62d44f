// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/cutting_force.h"

#include <algorithm>
#include <cmath>

#include "kernel/math/rotation.h"
#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

/// Weight of travel along the rays, relative to travel across them, in crossing a column's square:
/// small, but enough to deliver pending amounts when the tool retracts along the rays.
constexpr double kAlongRays = 0.25;
/// Least path of delivered elements, relative to the path by which their queues advanced. It bounds
/// the force when the tool turns about elements that are still to be delivered.
constexpr double kDuePathMin = 0.8;

Twist twist_of(const ToolMotion& motion) {
  return {motion.to.tip_mm - motion.from.tip_mm,
          normalized(cross(motion.from.axis, motion.to.axis)) * motion.turn_rad};
}

/// A displacement relative to the squares of the columns: the distance by which it crosses them,
/// and the share of a cut that is due to crossing them.
struct Crossing {
  double mm, share;
};
Crossing crossing_of(double across_mm, double along_mm) {
  const double across2 = across_mm * across_mm;
  const double along2 = along_mm * along_mm * (kAlongRays * kAlongRays);
  const double both2 = across2 + along2;
  return {std::sqrt(both2), both2 > 0 ? across2 / both2 : 0};
}
Crossing crossing_of(Vec3 d) { return crossing_of(std::sqrt(d.x * d.x + d.y * d.y), d.z); }

/// Returns the mean path of a cut's elements, mm: the work of their unit pushes over the sub-motion
/// per volume. Over this path, a force of u per area does the work u V for any motion.
double mean_path_mm(const CutSum& cut, const Twist& twist, Vec3 pivot) {
  if (!(cut.volume_mm3 > 0)) return 0;
  const Wrench push{cut.push_mm3, cut.turn_mm4};
  return -work(push, {twist.at(pivot), twist.angular}) / cut.volume_mm3;
}

/// Returns the mean path, mm, of elements that were partly cut by earlier motions. If the tool has
/// changed direction since, their pushes do less work. The path of their centroid, which is never
/// longer than the mean, is then used.
double delivered_path_mm(const CutSum& cut, const Twist& twist, Vec3 pivot) {
  return std::max(mean_path_mm(cut, twist, pivot), length(twist.at(cut.center_mm())));
}

/// Returns the share of a pending milling force that is felt: all of it up to a right angle to the
/// direction in which it was cut, and none behind.
double kept_share(const CutSum& due, Vec3 direction) {
  const double push = length(due.push_mm3);
  return push > 0 ? std::clamp(1 - 2 * dot(due.push_mm3, direction) / push, 0.0, 1.0) : 1;
}

CutSum to_world(RayAxis axis, const CutSum& s) {
  return {s.volume_mm3, from_frame(axis, s.moment_mm4), from_frame(axis, s.push_mm3),
          from_frame(axis, s.turn_mm4)};
}

}  // namespace

CutSummer make_summer(const ForceSettings& settings, const Tool& tool, const DexelField& field,
                      const ToolMotion& motion, const SurfaceWeight* weight) {
  const ToolPose middle = motion.at(0.5);
  const CutFrame frame{middle.tip_mm, middle.axis, settings.pivot_mm,
                       tool.length_mm + tool.radius_mm, tool.radius_mm};
  return {field.grid(), twist_of(motion), frame, weight, &field.shares()};
}

CuttingForce::CuttingForce(const ForceSettings& settings, const Tool& tool,
                           const ToolMotion& motion, double duration_s, int fields,
                           Engagement& engagement)
    : settings_(settings),
      motion_(motion),
      duration_s_(duration_s),
      weighted_(fields > 1),
      engagement_(engagement) {
  if (settings.law != ForceLaw::kMechanistic) return;
  std::unique_ptr<MillingEngagement>& milling = engagement.milling;
  if (!milling) milling = std::make_unique<MillingEngagement>(engagement.gradual.width_mm());
  if (milling->zero == Vec3{}) milling->zero = any_perpendicular(motion.from.axis);
  milling_.emplace(settings.milling, tool, motion.from.axis, milling->zero, duration_s);
}

void CuttingForce::Part::add(const CutSum& s, double share, double path_mm) {
  sum = sum + s;
  swept_mm4 += s.volume_mm3 * path_mm / share;
}

double CuttingForce::Part::path_mm() const {
  return sum.volume_mm3 > 0 ? swept_mm4 / sum.volume_mm3 : 0;
}

void CuttingForce::add(const DexelField& field, const CutSummer& summer, const TileSum& sums,
                       const Removal& removal, double share) {
  const Twist& twist = summer.twist();
  const MovedSum local = summer.total(sums);
  const CutSum sum = to_world(field.grid().axis, local.cut);
  all_.add(sum, share, mean_path_mm(local.cut, twist, summer.frame().axis * settings_.pivot_mm));
  const Crossing crossing =
      weighted_ ? Crossing{0, 0} : crossing_of(local.across_mm, local.along_mm);
  if (milling_)
    milling_->add(removal, field, twist, summer.frame(), share, crossing.share, weighted_);
  if (weighted_) return;
  gradual_.add(sum * crossing.share, share, crossing.mm);
}

/// Returns the pending push of earlier motions as it was when cut, but without its component along
/// the tool's present direction. A tool that turns back cuts nothing, and must not be driven by the
/// force.
CutSum CuttingForce::not_driving(CutSum due, Vec3 direction) const {
  const double along = dot(due.push_mm3, direction);
  if (along <= 0) return due;
  const Vec3 taken = direction * -along;
  const Vec3 axis = motion_.to.axis;
  const Vec3 turn = cross(due.center_mm() - axis * settings_.pivot_mm, taken);
  due.push_mm3 = due.push_mm3 + taken;
  due.turn_mm4 = due.turn_mm4 + turn - axis * dot(turn, axis);
  return due;
}

FeltCut CuttingForce::finish() {
  Engagement& e = engagement_;
  if (motion_.turn_rad > 0) e.turn({motion_.from.axis, motion_.to.axis});
  const Twist twist = twist_of(motion_);
  const Vec3 displacement = twist.at(all_.sum.volume_mm3 > 0 ? all_.sum.center_mm() : e.center_mm);
  const double distance_mm = length(displacement);
  e.direction = (e.direction * kFeltTravelMm + displacement) * (1 / (kFeltTravelMm + distance_mm));
  const Vec3 direction = normalized(e.direction);

  const Vec3 pivot = motion_.at(0.5).axis * settings_.pivot_mm;
  // Pending amounts are delivered over their own path. Over that of the motion's cut, a tool that
  // turns about them would deliver them at once.
  double path_mm = distance_mm, crossing_mm = crossing_of(displacement).mm;
  const CutSum gradual_pending = e.gradual.pending(), prompt_pending = e.prompt.pending();
  const double gradual_path_mm = delivered_path_mm(gradual_pending, twist, pivot);
  const double prompt_path_mm = delivered_path_mm(prompt_pending, twist, pivot);
  double ahead_mm = 0;
  if (all_.sum.volume_mm3 > 0) {
    path_mm = all_.path_mm();
    if (gradual_.sum.volume_mm3 > 0) crossing_mm = gradual_.path_mm();
    if (path_mm > kRestEpsilonMm) e.crossing_per_mm = crossing_mm / path_mm;
    ahead_mm = path_mm > 0 ? crossing_mm * (gradual_path_mm / path_mm) : crossing_mm;
  } else {
    ahead_mm = std::max(crossing_mm, mean_path_mm(gradual_pending, twist, pivot));
    path_mm = std::max(path_mm, mean_path_mm(gradual_pending + prompt_pending, twist, pivot));
  }
  const CutSum gradual = e.gradual.advance(ahead_mm), prompt = e.prompt.advance(prompt_path_mm);
  const CutSum now = e.gradual.take(gradual_.sum, crossing_mm) +
                     e.prompt.take(all_.sum + gradual_.sum * -1, path_mm);
  const double volume = gradual.volume_mm3 + prompt.volume_mm3 + now.volume_mm3;
  const double advanced_mm = volume > 0
                                 ? (gradual.volume_mm3 * gradual_path_mm +
                                    prompt.volume_mm3 * prompt_path_mm + now.volume_mm3 * path_mm) /
                                       volume
                                 : path_mm;
  const double due_path_mm =
      std::max(delivered_path_mm(gradual + prompt + now, twist, pivot), advanced_mm * kDuePathMin);
  const CutSum due = not_driving(gradual, direction) + not_driving(prompt, direction) + now;
  FeltCut felt;
  felt.volume_mm3 = due.volume_mm3;
  if (due.volume_mm3 > 0) e.center_mm = due.center_mm();
  const bool rests = path_mm <= kRestEpsilonMm;
  const CutSum per_mm = rests ? e.gradual.due_per_mm() * e.crossing_per_mm + e.prompt.due_per_mm()
                              : due * (1 / due_path_mm);
  felt.area_mm2 = per_mm.volume_mm3;
  felt.center_mm = motion_.at(0.5).tip_mm + e.center_mm;
  if (milling_) {
    felt.wrench = milling_->finish(
        *e.milling, {crossing_mm, path_mm, ahead_mm, prompt_path_mm, due_path_mm, e.crossing_per_mm,
                     rests, kept_share(gradual, direction), kept_share(prompt, direction)});
  } else if (settings_.law == ForceLaw::kDexelRemovalRate) {
    const double scale = settings_.drr_n_s_per_mm3 / duration_s_;
    felt.wrench = {due.push_mm3 * scale, due.turn_mm4 * scale};
  } else {
    const double scale = settings_.specific_force_n_per_mm2;
    felt.wrench = {per_mm.push_mm3 * scale, per_mm.turn_mm4 * scale};
  }
  return felt;
}

}  // namespace kerf
