// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "haptic_agent/device/haptic_device.h"
#include "haptic_agent/servo/contact_model.h"

namespace kerf::agent {

/// Returns the cut-off frequency of the velocity filter for a device, Hz, at least `usual_hz`. The
/// filter's delay limits the stiffness of a device that turns easily: 100 Hz (1.6 ms) would halve
/// that of a pen of 1e-5 kg m^2, which weighs 2.6 g at its tip. The dampers of such a device are so
/// weak that they pass little of the encoders' noise, so below 20 g the delay is 1/12.5 s/kg of the
/// tip's mass. `pivot_mm`: distance from the tip.
double velocity_cutoff_hz(const DeviceCapabilities& device, double pivot_mm,
                          double usual_hz) noexcept;

/// Returns the limits of contacts on a device: its mechanics, delays, declared stiffness and
/// declared damping (4 N s/m if it declares none). The declared damping holds without latency. It
/// is reduced by the ratio of the velocity's delay without latency to that with latency, and so
/// that one encoder step (0.02 mm if the device declares none) changes the damper's force by at
/// most 0.1 N.
ContactLimits contact_limits(const DeviceCapabilities& device, double velocity_cutoff_hz) noexcept;

}  // namespace kerf::agent
