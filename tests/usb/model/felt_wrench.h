// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "haptic_agent/device/reference/pen.h"

namespace kerf::usb_test {

/// Returns the wrench at the grip for motor torques (front arm first): each arm's force from its
/// torques, by finite differences of the arm's end point. The inverse of the driver's computation,
/// sharing only arm_point with it.
Wrench felt_wrench(const agent::PenShape& pen, const agent::PenAngles& q,
                   const std::array<double, 6>& motors_nmm);

}  // namespace kerf::usb_test
