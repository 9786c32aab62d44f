// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "kernel/force/milling_settings.h"

namespace kerf {

/// Force law of cutting. kDexelRemovalRate ("drr" in scenes): the paper's law; force is
/// proportional to the volume removed per second, hence viscous. kSpecificEnergy
/// ("specific_energy"): force is proportional to the engaged area, as in real cutting. kMechanistic
/// ("mechanistic"): the force of a milling cutter from the coefficients of its edges, with the
/// ripple of its teeth.
enum class ForceLaw : std::uint8_t { kDexelRemovalRate, kSpecificEnergy, kMechanistic };

/// Returns "drr", "specific_energy" or "mechanistic", the names used in scenes.
constexpr const char* to_string(ForceLaw law) {
  if (law == ForceLaw::kDexelRemovalRate) return "drr";
  return law == ForceLaw::kSpecificEnergy ? "specific_energy" : "mechanistic";
}

/// Parameters of the force and torque of a cut (paper section 3, per unit time). All are finite and
/// >= 0.
struct ForceSettings {
  ForceLaw law = ForceLaw::kSpecificEnergy;
  double specific_force_n_per_mm2 = 0.5;  ///< u of F = u A, A = removed volume / path
  double drr_n_s_per_mm3 = 0.0005;        ///< K of F = K dV/dt
  double pivot_mm = 60;  ///< distance of the torque's pivot from the tip, along the axis
  double contact_stiffness_n_per_mm = 1;  ///< of the stock, for shank and holder
  MillingSettings milling{};              ///< for kMechanistic
};

}  // namespace kerf
