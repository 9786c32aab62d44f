// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/servo/contact_model.h"

namespace kerf::agent {

/// Returns the cut-off frequency for the velocity of a device, Hz, at least `usual_hz`. The
/// filter's delay limits the stiffness of a device that turns easily, whose dampers are so weak
/// that they pass little of the encoders' noise: such a one gets a shorter filter. `pivot_mm`: from
/// the tip.
double velocity_cutoff_hz(const DeviceCapabilities& device, double pivot_mm,
                          double usual_hz) noexcept;

/// Returns the limits of contacts on a device (README.md, "Stiffness"): its declared stiffness;
/// its declared damping, which holds without latency, as far as the latency permits and the step of
/// an encoder does not move the damper's force by more than 0.1 N; its mechanics and delays.
ContactLimits contact_limits(const DeviceCapabilities& device, double velocity_cutoff_hz) noexcept;

}  // namespace kerf::agent
