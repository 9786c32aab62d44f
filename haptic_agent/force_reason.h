// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "haptic_agent/servo/supervisor.h"

namespace kerf::agent {

/// Returns the cause of a trip and its remedy. A sentence without its full stop.
std::string_view trip_reason(TripCode code);

/// Returns how the user of a device re-arms it after a trip. A clause in the imperative.
std::string_view rearm_remedy(const DeviceCapabilities& device);

/// The sentences for NoForce: why there is no or less force, each with the remedy.
class ForceReasons {
 public:
  explicit ForceReasons(const DeviceCapabilities& device);

  /// One sentence without its full stop. Empty for kNone. `code` is used for kTripped only. Valid
  /// during the lifetime of the object.
  const std::string& of(NoForce reason, TripCode code) const noexcept {
    return reason == NoForce::kTripped ? tripped_[static_cast<std::size_t>(code)]
                                       : other_[static_cast<std::size_t>(reason)];
  }

 private:
  std::array<std::string, kNoForceNames.size()> other_;
  std::array<std::string, kTripNames.size()> tripped_;
};

}  // namespace kerf::agent
