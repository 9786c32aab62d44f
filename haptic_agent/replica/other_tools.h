// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>

#include "haptic_agent/replica/other_tool.h"

namespace kerf::agent {

/// The tools of other participants near this agent's, and what they are about to cut.
class OtherTools {
 public:
  /// Takes the poses that the server has sent, at the time of this agent's newest sample, us.
  void take(const wire::Intents& intents, std::uint64_t now_us);
  /// Returns whether a tool is near; forgets those that have gone.
  bool are_near(std::uint64_t now_us);
  /// Returns whether a tool has not gone where it was expected.
  bool are_off(std::uint64_t now_us);
  /// The block no longer has what was cut for them.
  void restart();
  /// Removes from `block` what they cut until now (OtherTool::cut).
  void cut(Sculpture& block, std::uint64_t now_us);

 private:
  std::map<std::uint32_t, OtherTool> tools_;  ///< by participant
};

}  // namespace kerf::agent
