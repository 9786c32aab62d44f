// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "haptic_agent/link/control_message.h"
#include "haptic_agent/servo/servo_cycle.h"

namespace kerf::agent {

/// Returns a sentence for the user if cuts with a tool may exceed the device's limits. It states
/// the engaged area from which on force and torque are reduced, and the factor at `full_cut_mm2`,
/// an upper bound of the tool's engaged area. Empty if no cut does, or if the device has no motors.
std::string force_notice(const Welcome& welcome, const ServoSettings& settings, std::uint32_t tool,
                         double full_cut_mm2);

/// Returns a sentence for the user of a device that is so light for its latency that the force of a
/// cut follows the tip softly (CutCoupling), with the expected error in a hand that yields. Empty
/// for other devices, for a law without that coupling, and for a device without motors.
std::string grip_notice(const ServoSettings& settings);

}  // namespace kerf::agent
