// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "haptic_agent/servo/felt.h"

namespace kerf::agent {

/// A scene of the repository or a template of the server, and its carver: a program of kerf-demo
/// (1, 2), or the figure of `--device sim` (0).
struct ShippedScene {
  std::string file;  ///< relative to the source folder, or "template:ID"
  int program = 0;
};
const std::vector<ShippedScene>& shipped_scenes();

/// The force felt with the 5-DOF reference device, after the ramp.
struct ShippedFeel {
  FeltReport agent;                      ///< against the wrench computed by the agent's replica
  FeltSums server_force, server_torque;  ///< against the server's result for this tick's pose alone
  /// The server's results one tick late, against the same. No device gets them sooner.
  FeltSums late_force, late_torque;
  std::uint64_t trips = 0;
};

/// Carves a scene for at most `seconds` on the real session, in virtual time without delay, along
/// the exact path of a rigid hand. Throws std::runtime_error if a file cannot be read.
ShippedFeel feel_shipped(const ShippedScene& scene, double seconds);

}  // namespace kerf::agent
