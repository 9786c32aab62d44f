// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "haptic_agent/device/reference/pen.h"

namespace kerf::usb_test {

/// What a hand at the grip feels of motors that pull with these torques (front arm first): each
/// arm's force from its torques, by finite differences of where the arm ends. The driver's way back
/// to front, and none of its code but the arm's position.
Wrench felt_wrench(const agent::PenShape& pen, const agent::PenAngles& q,
                   const std::array<double, 6>& motors_nmm);

}  // namespace kerf::usb_test
