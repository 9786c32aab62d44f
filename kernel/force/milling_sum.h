// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "kernel/force/cut_sum.h"
#include "kernel/force/milling_settings.h"

namespace kerf {

inline constexpr double kMillingPi = 3.14159265358979323846;

/// Greatest number of frequencies in the ripple of a milling force.
inline constexpr int kHarmonicsMax = 3;

/// A wrench that depends on the angle θ of the spindle: mean + Σ_k cos kθ · cosine + sin kθ · sine.
struct MillingSpectrum {
  Wrench mean;
  int count = 0;  ///< of frequencies; beyond it, the coefficients are 0
  std::array<Wrench, kHarmonicsMax> cosine, sine;
};

/// Sums over the removed elements of a cut, from which the mechanistic law computes its wrench. V
/// is the volume, ρ the distance from the axis, A the area of the cut surface, and K the
/// coefficients as a vector.
struct MillingSum {
  double volume_mm3 = 0;
  MillingSpectrum cut;   ///< Σ V K_cut / ρ
  MillingSpectrum edge;  ///< Σ A · path · K_edge / ρ
};

MillingSum operator+(const MillingSum& a, const MillingSum& b);
MillingSum operator*(const MillingSum& a, double s);
/// Returns the sum that results if tool and cut are turned together.
MillingSum turned(const MillingSum& sum, const Turn& turn);

/// Converts from the frame of a field to the world.
MillingSum to_world(RayAxis axis, const MillingSum& sum);

/// Frequencies of the ripple, in multiples of the spindle's.
struct Harmonics {
  std::array<int, kHarmonicsMax> multiple{};
  int count = 0;
  /// Strength of the edge terms of the first frequency, the spindle's own, caused by runout, in mm.
  /// The chip is that much thicker per tooth and radian. 0 without runout.
  double runout_mm = 0;
};
/// Returns the frequencies up to ripple_hz: that of runout first, then those of the passing teeth.
Harmonics harmonics_of(const MillingSettings& settings);

}  // namespace kerf
