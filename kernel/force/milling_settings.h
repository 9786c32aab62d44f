// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf {

/// Coefficients of the force on a cutting edge, in the directions of its cut: against the tooth's
/// motion; normal to the surface that it cuts, into the tool; along the edge's generator, towards
/// the tip.
struct EdgeCoefficients {
  double tangential = 0, radial = 0, axial = 0;

  bool operator==(const EdgeCoefficients&) const = default;
};
constexpr EdgeCoefficients in_all_directions(double value) { return {value, value, value}; }

/// Parameters of ForceLaw::kMechanistic (kernel/force/mechanistic.md). The spindle turns clockwise
/// as seen along the axis towards the tip (M3).
struct MillingSettings {
  double spindle_rpm = 12000;    ///< 1 to 1e6
  int teeth = 2;                 ///< 1 to 100, evenly spaced
  double helix_deg = 30;         ///< 0 to 80; right-handed
  double feed_per_tooth_mm = 0;  ///< fixed chip load; 0 uses the motion's speed
  double runout_mm = 0;          ///< offset of the tool's axis from the spindle's
  double ripple_hz = 250;        ///< greatest frequency of the ripple; 0 gives mean forces only
  double scale = 1;              ///< of the whole wrench; at most 1
  EdgeCoefficients cut_n_per_mm2;
  EdgeCoefficients edge_n_per_mm;
  /// m of Kienzle's law, in [0, 0.9]: a chip of thickness h has cut_n_per_mm2 · (h / 1 mm)^−m.
  EdgeCoefficients chip_exponents;
};

/// Greatest coefficient, in its unit, and greatest ripple_hz.
inline constexpr double kForceCoefficientMax = 1e6;
inline constexpr double kFeedPerToothMaxMm = 100;
inline constexpr double kRunoutMaxMm = 1;
/// Below this speed a tooth would take minutes, and the feed per tooth has no bound.
inline constexpr double kSpindleMinRpm = 1;
inline constexpr double kSpindleMaxRpm = 1e6;
inline constexpr int kTeethMax = 100;
inline constexpr double kHelixMaxDeg = 80;
inline constexpr double kChipExponentMax = 0.9;

}  // namespace kerf
