// SPDX-License-Identifier: Apache-2.0
#include "haptic_agent/servo/mapping/block_settings.h"

namespace kerf::agent {

ServoSettings block_settings(const ServoSettings& device,
                             const WorkspaceMapping& mapping) noexcept {
  ServoSettings block = device;
  const double per_force = 1 / mapping.stiffness_scale(), per_torque = 1 / mapping.torque_gain();
  ContactLimits& contact = block.model.contact;
  contact.max_stiffness *= per_force;
  contact.max_damping *= per_force;
  contact.mass_kg *= per_force;
  contact.inertia_kg_m2 *= per_torque;
  block.model.max_damping *= per_force;
  PassivitySettings& passivity = block.passivity;
  passivity.max_damping *= per_force;
  passivity.max_turn_damping *= per_torque;
  passivity.mass_kg *= per_force;
  passivity.inertia_kg_m2 *= per_torque;
  block.pivot_mm *= mapping.scale;
  return block;
}

}  // namespace kerf::agent
