// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kerf::sim {

/// Token of the administrator of servers with rights, and the line of a header that shows it.
inline constexpr const char* kAdminToken = "0123456789abcdef0123456789abcdef";
inline constexpr const char* kAsAdmin =
    "Authorization: Bearer 0123456789abcdef0123456789abcdef\r\n";

/// The scene of simulated sessions: small, so that worlds are cheap.
inline constexpr const char* kScene = R"({
  "name": "block",
  "stock": {"shape": "box", "min_mm": [-20, -20, -20], "max_mm": [20, 20, 0]},
  "accuracy": {"rays": "dexel", "pitch_mm": 0.5, "tolerance_mm": 0.01, "motion": "tight"},
  "tools": [{"id": 1, "shape": "ball", "diameter_mm": 6, "length_mm": 60},
            {"id": 2, "shape": "flat", "diameter_mm": 4, "length_mm": 60}],
  "machine": {"kinematics": "tool-vector"}})";

}  // namespace kerf::sim
