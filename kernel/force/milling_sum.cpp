// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/milling_sum.h"

#include <algorithm>

#include "kernel/math/rotation.h"

namespace kerf {
namespace {

MillingSpectrum operator+(const MillingSpectrum& a, const MillingSpectrum& b) {
  MillingSpectrum sum;
  sum.mean = a.mean + b.mean;
  sum.count = std::max(a.count, b.count);
  for (std::size_t k = 0; k < std::size_t(sum.count); ++k) {
    sum.cosine[k] = a.cosine[k] + b.cosine[k];
    sum.sine[k] = a.sine[k] + b.sine[k];
  }
  return sum;
}

/// Applies a function to each vector.
template <class Change>
MillingSpectrum changed(const MillingSpectrum& s, const Change& change) {
  const auto both = [&](const Wrench& w) {
    return Wrench{change(w.force_n), change(w.torque_nmm)};
  };
  MillingSpectrum result;
  result.mean = both(s.mean);
  result.count = s.count;
  for (std::size_t k = 0; k < std::size_t(s.count); ++k) {
    result.cosine[k] = both(s.cosine[k]);
    result.sine[k] = both(s.sine[k]);
  }
  return result;
}

}  // namespace

MillingSum operator+(const MillingSum& a, const MillingSum& b) {
  return {a.volume_mm3 + b.volume_mm3, a.cut + b.cut, a.edge + b.edge};
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
    // A tooth leads the previous one by e (cos 2πj/N − cos 2π(j−1)/N). The first harmonic of the N
    // teeth has the amplitude e N sin π/N, with two teeth twice that. Per tooth:
    h.runout_mm = s.runout_mm * sin_cos(kMillingPi / s.teeth).sin * (s.teeth == 2 ? 2 : 1);
    h.multiple[0] = 1;
    h.count = 1;
  }
  for (int k = s.teeth; h.count < kHarmonicsMax && k * turns_per_s <= s.ripple_hz; k += s.teeth) {
    h.multiple[static_cast<std::size_t>(h.count++)] = k;
  }
  return h;
}

}  // namespace kerf
