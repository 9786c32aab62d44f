// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/servo/contact_model.h"

namespace kerf::agent {

/// Returns the cut-off frequency of the velocity filter for a device, Hz, at least `usual_hz`. The
/// filter's delay limits the stiffness of a device that turns easily. Its dampers are so weak that
/// they pass little of the encoders' noise, so such a device gets a shorter filter. `pivot_mm`:
/// distance from the tip.
double velocity_cutoff_hz(const DeviceCapabilities& device, double pivot_mm,
                          double usual_hz) noexcept;

/// Returns the limits of contacts on a device (theory.md, "Stiffness"): its mechanics, delays and
/// declared stiffness, and its declared damping. The damping holds without latency. It is reduced
/// by the latency, and so that one encoder step changes the damper's force by at most 0.1 N.
ContactLimits contact_limits(const DeviceCapabilities& device, double velocity_cutoff_hz) noexcept;

}  // namespace kerf::agent
