// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/milling_force.h"

#include <algorithm>
#include <cmath>

#include "kernel/math/rotation.h"
#include "kernel/math/tolerance.h"

namespace kerf {
namespace {

/// Most turns of a harmonic in a motion. A faster one is meaningless in a mean over the motion.
constexpr double kTurnsMax = 0.5;

double fraction(double turns) { return turns - std::floor(turns); }

/// Returns sine and cosine of an angle in turns.
SinCos at_turns(double turns) {
  return sin_cos(2 * kMillingPi * (turns - std::floor(turns + 0.5)));
}

}  // namespace

MillingForce::MillingForce(const MillingSettings& settings, const Tool& tool, Vec3 axis, Vec3 zero,
                           double duration_s)
    : settings_(settings),
      harmonics_(harmonics_of(settings)),
      side_(tool),
      axis_(axis),
      zero_(zero),
      duration_s_(duration_s) {}

double MillingForce::feed_per_tooth_mm(double path_mm, double duration_s) const {
  if (settings_.feed_per_tooth_mm > 0) return settings_.feed_per_tooth_mm;
  return path_mm / (duration_s * turns_per_s() * settings_.teeth);
}

void MillingForce::add(const Removal& removal, const DexelField& field, const Twist& twist,
                       const CutFrame& frame, double share, double gradual, bool weighted) {
  const double path_mm = length(twist.linear) + length(twist.angular) * frame.reach_mm;
  if (!(path_mm > 0)) return;
  const DexelGrid& grid = field.grid();
  const Vec3 zero = Turn(to_frame(grid.axis, axis_), frame.axis)(to_frame(grid.axis, zero_));
  const MillingPass pass{.settings = settings_,
                         .harmonics = harmonics_,
                         .side = side_,
                         .twist = twist,
                         .frame = frame,
                         .zero = normalized(zero - frame.axis * dot(zero, frame.axis)),
                         .feed_per_mm = feed_per_tooth_mm(path_mm, share * duration_s_) / path_mm,
                         .weighted = weighted,
                         .shares = &field.shares()};
  const MillingSum sum = to_world(grid.axis, sum_milling(removal, grid, pass));
  gradual_ = gradual_ + sum * gradual;
  prompt_ = prompt_ + sum * (1 - gradual);
}

/// Returns the mean of a spectrum over a motion at whose end the spindle has turned by `turns`
/// since the phase began. Harmonics are reduced to their mean over the motion.
Wrench MillingForce::at(const MillingSpectrum& spectrum, double turns, double duration_s) const {
  Wrench sum = spectrum.mean;
  for (int n = 0; n < harmonics_.count; ++n) {
    const auto k = static_cast<std::size_t>(n);
    const double passed = harmonics_.multiple[k] * turns_per_s() * duration_s;
    if (passed > kTurnsMax) continue;
    const double half = kMillingPi * passed;
    const double kept = half > 0 ? sin_cos(half).sin / half : 1;
    const SinCos angle = at_turns(harmonics_.multiple[k] * turns);
    sum = sum + (spectrum.cosine[k] * angle.cos + spectrum.sine[k] * angle.sin) * (2 * kept);
  }
  return sum;
}

Wrench MillingForce::finish(MillingEngagement& e, const MillingTravel& t) const {
  const MillingSum later = e.gradual.advance(t.gradual_mm) * t.gradual_kept +
                           e.prompt.advance(t.prompt_mm) * t.prompt_kept;
  MillingSum due =
      later + e.gradual.take(gradual_, t.crossing_mm) + e.prompt.take(prompt_, t.path_mm);
  const bool engaged =
      due.volume_mm3 > 0 || e.gradual.pending_mm3() > 0 || e.prompt.pending_mm3() > 0;
  if (!engaged) {
    e.turns = 0;
    e.zero = {};
    return {};
  }
  const double turned = turns_per_s() * duration_s_;
  const double middle = fraction(e.turns + turned / 2);
  e.turns = fraction(e.turns + turned);
  double path_mm = t.due_path_mm;
  const bool fixed = settings_.feed_per_tooth_mm > 0;
  if (t.rests) {
    if (!fixed) return {};
    due = e.gradual.due_per_mm() * t.crossing_per_mm + e.prompt.due_per_mm();
    path_mm = 1;
  }
  if (!(path_mm > 0)) return {};
  const double feed_mm = feed_per_tooth_mm(path_mm, duration_s_);
  const double per_path = settings_.teeth / (2 * kMillingPi * path_mm) * settings_.scale;
  const double fade = std::min(1.0, feed_mm / kRestFeedMm);
  const Wrench cut = at(due.cut, middle, duration_s_), edge = at(due.edge, middle, duration_s_);
  return cut * (per_path * feed_mm) + edge * (per_path * fade);
}

double milling_force_n(const MillingSettings& s, double radius_mm, double mm3_per_s) {
  const double speed_mm_per_s = 2 * kMillingPi * radius_mm * s.spindle_rpm / 60;
  const EdgeCoefficients& k = s.cut_n_per_mm2;
  return s.scale * std::sqrt(k.tangential * k.tangential + k.radial * k.radial) * mm3_per_s /
         speed_mm_per_s;
}

}  // namespace kerf
