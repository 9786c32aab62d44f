// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/milling_sum.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "kernel/math/power.h"
#include "kernel/math/rotation.h"

namespace kerf {
namespace {

/// Elements are divided into parts of this share of the tool's radius along the rays, so that the
/// angle at which a helical edge cuts them is nearly the same over each.
constexpr double kPartShare = 0.2;
constexpr int kPartsMax = 256;
/// Parts that one sub-motion is summed over, about: of more, every n-th element counts for n.
constexpr double kPartsMost = 16384;
/// Least sine of the angle between the surface and the displacement. Where the edge of an
/// engagement grazes the surface, one column would count as an unbounded area.
constexpr double kGrazingSine = 0.02;
/// Least distance from the axis, in radii of the tool: the cutting speed is zero on the axis.
constexpr double kAxisShare = 0.05;
/// Thinnest chip of Kienzle's law, mm: its coefficient is unbounded at 0.
constexpr double kChipMinMm = 0.001;
/// Most evaluations of the surface in the search for the pose at which a motion cut an element.
constexpr int kEntryEvaluations = 8;
/// As many where the path is short.
constexpr int kNearEvaluations = 2;
/// Distance from the surface, in radii of the tool, at which the search ends.
constexpr double kEntryShare = 0.0005;

void add(MillingSpectrum& sum, const MillingSpectrum& s, double scale) {
  sum.mean = sum.mean + s.mean * scale;
  for (std::size_t k = 0; k < sum.cosine.size(); ++k) {
    sum.cosine[k] = sum.cosine[k] + s.cosine[k] * scale;
    sum.sine[k] = sum.sine[k] + s.sine[k] * scale;
  }
}

/// Applies a function to each vector.
template <class Change>
MillingSpectrum changed(const MillingSpectrum& s, const Change& change) {
  const auto both = [&](const Wrench& w) {
    return Wrench{change(w.force_n), change(w.torque_nmm)};
  };
  MillingSpectrum result{both(s.mean), {}, {}};
  for (std::size_t k = 0; k < s.cosine.size(); ++k) {
    result.cosine[k] = both(s.cosine[k]);
    result.sine[k] = both(s.sine[k]);
  }
  return result;
}

/// Cosine and sine of an angle of the spindle.
struct Phase {
  double cosine, sine;
};
Phase operator*(Phase a, Phase b) {
  return {a.cosine * b.cosine - a.sine * b.sine, a.sine * b.cosine + a.cosine * b.sine};
}
Phase raised(Phase base, int exponent) {
  Phase result{1, 0};
  for (; exponent > 0; exponent /= 2, base = base * base) {
    if (exponent % 2 == 1) result = result * base;
  }
  return result;
}
Phase phase_of(double angle_rad) {
  const double turns = angle_rad / (2 * kMillingPi);
  const SinCos sc = sin_cos(2 * kMillingPi * (turns - std::floor(turns + 0.5)));
  return {sc.cos, sc.sin};
}

/// Where a point of the stock meets the tool.
struct Contact {
  Vec3 arm;     ///< from the tip
  Vec3 radial;  ///< unit vector from the axis; zero on it
  double rho, h;
  ToolSide::Nearest side;
};

/// Sums the elements of one sub-motion.
class MillingSums {
 public:
  explicit MillingSums(const MillingPass& pass)
      : p_(pass),
        quarter_(cross(pass.zero, pass.frame.axis)),
        lag_per_mm_(tangent(pass.settings.helix_deg) / pass.frame.radius_mm) {}

  /// Adds a part of an element: at `middle` from the tip, of a volume. `near_mm`: a short path.
  void add_part(Vec3 middle, double volume_mm3, double near_mm);
  MillingSum sum() const { return sum_; }

 private:
  static double tangent(double deg) {
    const SinCos sc = sin_cos(deg * kMillingPi / 180);
    return sc.sin / sc.cos;
  }
  Contact contact_at(Vec3 arm) const;
  Vec3 normal_of(const Contact& c) const {
    return c.radial * c.side.radial + p_.frame.axis * c.side.axial;
  }
  Contact entered(Vec3 middle, Vec3 path, int evaluations) const;
  Wrench push(const EdgeCoefficients& k, const Contact& c, Vec3 normal, double scale) const;
  void add_ripple(const Contact& c, const Wrench& cut, const Wrench& edge, const Wrench& runout);

  const MillingPass& p_;
  Vec3 quarter_;  ///< unit vector at a quarter of a turn of the spindle from `zero`
  double lag_per_mm_;
  MillingSum sum_;
};

Contact MillingSums::contact_at(Vec3 arm) const {
  if (p_.evaluations) ++*p_.evaluations;
  Contact c{.arm = arm, .radial = {}, .rho = 0, .h = dot(arm, p_.frame.axis), .side = {}};
  const Vec3 across = arm - p_.frame.axis * c.h;
  c.rho = length(across);
  if (c.rho > 0) c.radial = across * (1 / c.rho);
  c.side = p_.side.at(c.rho, c.h);
  return c;
}

/// Returns where the tool reached an element that is at `middle` from the tip in the middle of a
/// path: Newton's method from the start of the path. The distance from a convex piece is convex
/// along the path, so the steps do not pass its surface; where they enter another piece, the secant
/// leads back. If the tool only passes the element, as rounding may leave it, returns the nearest
/// pose found.
Contact MillingSums::entered(Vec3 middle, Vec3 path, int evaluations) const {
  const double path_mm = length(path), found_mm = kEntryShare * p_.frame.radius_mm;
  const Vec3 forward = path * (1 / path_mm);
  const Vec3 start = middle + path * 0.5;
  Contact best = contact_at(start), at = best;
  double travelled_mm = 0, before_mm = 0;
  for (int i = 1; i < evaluations && std::abs(best.side.distance_mm) > found_mm; ++i) {
    const double distance = at.side.distance_mm, outside = best.side.distance_mm;
    if (distance < 0 && at.arm == start) break;
    const double sine = dot(normal_of(at), forward);
    double next = travelled_mm;
    if (distance < 0) {
      next = before_mm + (travelled_mm - before_mm) * (outside / (outside - distance));
    } else {
      next += sine > 0 ? distance / sine : distance;
    }
    next = std::min(next, path_mm);
    if (!(next > before_mm) || next == travelled_mm) break;
    travelled_mm = next;
    at = contact_at(start - forward * travelled_mm);
    if (at.side.distance_mm < 0 || at.side.distance_mm > outside) continue;
    best = at;
    before_mm = travelled_mm;
  }
  return best;
}

Wrench MillingSums::push(const EdgeCoefficients& k, const Contact& c, Vec3 normal,
                         double scale) const {
  const Vec3 axis = p_.frame.axis;
  const Vec3 along = c.radial * c.side.axial - axis * c.side.radial;
  const Vec3 force =
      (cross(axis, c.radial) * k.tangential - normal * k.radial + along * k.axial) * scale;
  const Vec3 torque = cross(c.arm - axis * p_.frame.pivot_mm, force);
  return {force, torque - axis * dot(torque, axis)};
}

void MillingSums::add_ripple(const Contact& c, const Wrench& cut, const Wrench& edge,
                             const Wrench& runout) {
  const Phase angle =
      Phase{dot(c.radial, p_.zero), dot(c.radial, quarter_)} * phase_of(c.h * lag_per_mm_);
  for (int n = 0; n < p_.harmonics.count; ++n) {
    const auto k = static_cast<std::size_t>(n);
    const Phase phase = raised(angle, p_.harmonics.multiple[k]);
    const auto put = [&](MillingSpectrum& into, const Wrench& w) {
      into.cosine[k] = into.cosine[k] + w * phase.cosine;
      into.sine[k] = into.sine[k] + w * phase.sine;
    };
    if (n == 0 && p_.harmonics.runout_mm > 0) {
      put(sum_.edge, runout);
    } else {
      put(sum_.cut, cut);
      put(sum_.edge, edge);
    }
  }
}

void MillingSums::add_part(Vec3 middle, double volume_mm3, double near_mm) {
  const Vec3 path = p_.twist.at(middle);
  const double path_mm = length(path);
  if (!(path_mm > 0)) return;
  const Contact c = entered(middle, path, path_mm > near_mm ? kEntryEvaluations : kNearEvaluations);
  const Vec3 normal = normal_of(c);
  const double volume = p_.weighted ? volume_mm3 * (normal.z * normal.z) : volume_mm3;
  if (!(volume > 0)) return;
  const double sine = std::max(dot(normal, path) / path_mm, kGrazingSine);
  const double rho = std::max(c.rho, kAxisShare * p_.frame.radius_mm);
  const double m = p_.settings.chip_exponent;
  const double chip_mm = p_.feed_per_mm * path_mm * sine;
  const double thinner = m > 0 ? power(std::max(chip_mm, kChipMinMm), -m) : 1;
  const Wrench cut = push(p_.settings.cut_n_per_mm2, c, normal, volume / rho * thinner);
  const double edge_scale = volume / (sine * rho);
  const Wrench edge = push(p_.settings.edge_n_per_mm, c, normal, edge_scale);
  sum_.volume_mm3 += volume;
  sum_.cut.mean = sum_.cut.mean + cut;
  sum_.edge.mean = sum_.edge.mean + edge;
  if (p_.harmonics.count == 0) return;
  Wrench runout;
  if (p_.harmonics.runout_mm > 0) {
    runout = push(p_.settings.cut_n_per_mm2, c, normal,
                  edge_scale * thinner * (1 - m) * p_.harmonics.runout_mm);
  }
  add_ripple(c, cut, edge, runout);
}

/// Returns n where every n-th element is summed. It is odd, because rows and tiles are powers of 2.
std::int64_t stride_of(const Removal& removal, double length_mm, double part_mm) {
  const double parts = double(removal.elements()) + length_mm / part_mm;
  return 2 * static_cast<std::int64_t>(parts / kPartsMost / 2 + 0.5) + 1;
}

}  // namespace

MillingSum operator+(const MillingSum& a, const MillingSum& b) {
  MillingSum sum = a;
  sum.volume_mm3 += b.volume_mm3;
  add(sum.cut, b.cut, 1);
  add(sum.edge, b.edge, 1);
  return sum;
}

MillingSum operator*(const MillingSum& a, double s) {
  const auto scaled = [s](Vec3 v) { return v * s; };
  return {a.volume_mm3 * s, changed(a.cut, scaled), changed(a.edge, scaled)};
}

MillingSum turned(const MillingSum& sum, const Turn& turn) {
  return {sum.volume_mm3, changed(sum.cut, turn), changed(sum.edge, turn)};
}

MillingSum to_world(RayAxis axis, const MillingSum& sum) {
  const auto world = [axis](Vec3 v) { return from_frame(axis, v); };
  return {sum.volume_mm3, changed(sum.cut, world), changed(sum.edge, world)};
}

Harmonics harmonics_of(const MillingSettings& s) {
  Harmonics h;
  const double turns_per_s = s.spindle_rpm / 60;
  if (s.runout_mm > 0 && s.teeth > 1 && turns_per_s <= s.ripple_hz) {
    // A tooth leads the one before it by e (cos 2πj/N − cos 2π(j−1)/N); the first harmonic of the
    // N teeth has the amplitude e N sin π/N, with two teeth twice that. Per tooth:
    h.runout_mm = s.runout_mm * sin_cos(kMillingPi / s.teeth).sin * (s.teeth == 2 ? 2 : 1);
    h.multiple[0] = 1;
    h.count = 1;
  }
  for (int k = s.teeth; h.count < kHarmonicsMax && k * turns_per_s <= s.ripple_hz; k += s.teeth) {
    h.multiple[static_cast<std::size_t>(h.count++)] = k;
  }
  return h;
}

MillingSum sum_milling(const Removal& removal, const DexelGrid& grid, const MillingPass& pass) {
  MillingSums summing(pass);
  const double area = grid.pitch_mm * grid.pitch_mm, near_mm = grid.pitch_mm / 2;
  const double part_mm = kPartShare * pass.frame.radius_mm;
  const double length_mm = double(removal.quanta()) * grid.z_quantum_mm;
  const std::int64_t stride = stride_of(removal, length_mm, part_mm);
  std::int64_t element = stride / 2;
  double summed_mm = 0;
  for (const RemovedPart& part : removal.parts()) {
    for (const RemovedGroup& g : part.groups) {
      for (int c = 0; c < RemovedGroup::kLanes; ++c) {
        if (g.bottom[c] >= g.top[c] || ++element % stride != 0) continue;
        const double bottom = grid.z_mm(g.bottom[c]), top = grid.z_mm(g.top[c]);
        const Vec3 foot = Vec3{grid.x_mm(g.i + c), grid.y_mm(g.j), bottom} - pass.frame.tip_mm;
        const int parts = std::min(1 + static_cast<int>((top - bottom) / part_mm), kPartsMax);
        const double step = (top - bottom) / parts;
        summed_mm += top - bottom;
        for (int k = 0; k < parts; ++k) {
          summing.add_part(foot + Vec3{0, 0, (k + 0.5) * step}, step * area, near_mm);
        }
      }
    }
  }
  return stride > 1 && summed_mm > 0 ? summing.sum() * (length_mm / summed_mm) : summing.sum();
}

}  // namespace kerf
