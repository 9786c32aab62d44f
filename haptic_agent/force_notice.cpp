// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/force_notice.h"

#include <algorithm>
#include <sstream>

#include "haptic_agent/plain_number.h"
#include "haptic_agent/servo/cut_coupling.h"

namespace kerf::agent {
namespace {

/// The force that a law computes per engaged area, and the greatest that the device outputs, in N,
/// or in N s/mm for the law whose force grows with speed.
struct CutLoad {
  double per_mm2 = 0;
  double most = 0;
};

CutLoad load_of(const Welcome& welcome, const ServoSettings& settings) {
  if (welcome.law == CutLaw::kRemovalRate) {
    return {welcome.drr_n_s_per_mm3, settings.model.max_damping};
  }
  // The force acts near the tip, so its torque about the pivot is limited as well.
  const double at_tip_n = settings.pivot_mm > 0 ? settings.limits.torque_nmm / settings.pivot_mm
                                                : settings.limits.force_n;
  return {welcome.specific_force_n_per_mm2, std::min(settings.limits.force_n, at_tip_n)};
}

}  // namespace

std::string force_notice(const Welcome& welcome, const ServoSettings& settings, std::uint32_t tool,
                         double full_cut_mm2) {
  // The force per area of this law depends on the speed and the angles of engagement.
  if (welcome.law == CutLaw::kMechanistic) return {};
  const CutLoad load = load_of(welcome, settings);
  const double full = load.per_mm2 * full_cut_mm2;
  if (!settings.safety.motors || !(full > load.most)) return {};
  const bool viscous = welcome.law == CutLaw::kRemovalRate;
  const char* const unit = viscous ? " N s/mm" : " N";
  std::ostringstream out;
  out << "cuts may exceed the device: above " << plain_number(load.most / load.per_mm2, 2)
      << " mm² of engaged area (" << plain_number(load.most, 2) << unit;
  if (!viscous && load.most < settings.limits.force_n) {
    out << " at the tip, " << plain_number(settings.limits.torque_nmm, 3)
        << " N·mm about the pivot";
  }
  out << ") force and torque are felt reduced, both by one factor, down to "
      << plain_number(load.most / full, 2) << " in a full cut of tool " << tool << " ("
      << plain_number(full_cut_mm2, 3) << " mm², " << plain_number(full, 3) << unit << ")";
  return out.str();
}

std::string grip_notice(const ServoSettings& settings) {
  // `felt_bench hands`, 1 N, 0.5 N/mm: errors of 7 to 8 % below this stiffness, of 1 to 4 % above.
  constexpr double kFirmNPerMm = 0.2;
  if (!settings.safety.motors || settings.model.law == CutLaw::kRemovalRate) return {};
  const Vec3 arm_mm{0, 0, -settings.pivot_mm};
  const double stiffness = gains_across(cut_limits(settings.model.contact), arm_mm).stiffness;
  if (!(stiffness < kFirmNPerMm)) return {};
  std::ostringstream out;
  out << "the device is light for its latency: at its tip it can render "
      << plain_number(stiffness, 2)
      << " N/mm stably. Held loosely, the force of a cut follows each turn late, and is wrong by a "
         "tenth or more; a firm grip makes it true";
  return out.str();
}

}  // namespace kerf::agent
