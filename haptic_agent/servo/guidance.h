// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "haptic_agent/servo/grip_history.h"

namespace kerf::agent {

struct ServoSettings;

/// Forces that depend on the device's motion alone, in addition to those of the session: the guides
/// of the scene (haptic_agent/guides).
class Guidance {
 public:
  virtual ~Guidance() = default;
  /// Returns force and torque about the pivot at the newest grip. The servo thread calls it once
  /// per tick. It must not wait or allocate.
  virtual Wrench at(const PastGrip& now) noexcept = 0;
  /// The servo thread calls this when the mapping has changed. `settings`: those of the device as
  /// seen in the block (block_settings).
  virtual void adapt(const ServoSettings& settings) noexcept { static_cast<void>(settings); }
};

}  // namespace kerf::agent
