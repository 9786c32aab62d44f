// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "haptic_agent/servo/grip_history.h"

namespace kerf::agent {

/// Forces that depend on the device's motion alone, in addition to those of the session: the guides
/// of the scene (haptic_agent/guides).
class Guidance {
 public:
  virtual ~Guidance() = default;
  /// Returns force and torque about the pivot at the newest grip. Called by the servo thread, once
  /// per tick; neither waits nor allocates.
  virtual Wrench at(const PastGrip& now) noexcept = 0;
};

}  // namespace kerf::agent
