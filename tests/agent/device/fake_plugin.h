// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "haptic_agent/library/kerf_agent.h"

namespace kerf::agent {

/// Poses that the fake plugin reports and calls that it received. Its address is the plugin's
/// argument.
struct FakePluginLog {
  kerf_agent_capabilities capabilities{};
  kerf_agent_result rated = KERF_AGENT_OK;
  kerf_agent_pose pose{};
  kerf_agent_place place{};
  kerf_agent_wrench wrench{};
  std::uint64_t asked_us = 0;
  int stops = 0;
  int closes = 0;
};

}  // namespace kerf::agent
