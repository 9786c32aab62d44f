// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace kerf {

/// Every kind of cutter; number 11 has a shank and a holder, which do not cut.
inline constexpr const char* kRackScene = R"({
  "name": "Rack",
  "stock": {"shape": "box", "min_mm": [-20, -20, -20], "max_mm": [20, 20, 0]},
  "accuracy": {"rays": "RAYS", "pitch_mm": 0.6, "tolerance_mm": 0.02, "motion": "MOTION"},
  "tools": [
    {"id": 1, "shape": "ball", "diameter_mm": 8, "length_mm": 30},
    {"id": 2, "shape": "flat", "diameter_mm": 6, "length_mm": 30},
    {"id": 3, "shape": "taper", "diameter_mm": 2, "half_angle_deg": 8, "length_mm": 20},
    {"id": 4, "shape": "taper", "diameter_mm": 3, "half_angle_deg": 6, "length_mm": 20,
     "tip": "ball"},
    {"id": 5, "shape": "cone_end", "diameter_mm": 6, "tip_angle_deg": 90, "length_mm": 20},
    {"id": 6, "shape": "bull_nose", "diameter_mm": 8, "corner_radius_mm": 2, "length_mm": 30},
    {"id": 7, "shape": "apt", "d_mm": 10, "r_mm": 1.5, "e_mm": 3.630717035815369,
     "f_mm": 2.0250053615596113, "alpha_deg": 8, "beta_deg": 6, "h_mm": 25},
    {"id": 8, "shape": "profile",
     "profile_mm": [[0, 0], {"to": [1.5, 7], "radius": 3.75}, [1.5, 25]]},
    {"id": 9, "shape": "profile", "profile_mm": [[0, 0], [4, 0], [4, 2], [1.5, 2], [1.5, 25]]},
    {"id": 10, "shape": "profile", "profile_mm": [[0, 0], [4, 0], [2, 4], [2, 25]]},
    {"id": 11, "shape": "profile",
     "profile_mm": [[0, 0], {"to": [3, 8], "radius": 18}, [3, 12]],
     "shank": {"diameter_mm": 5, "length_mm": 10},
     "holder": [{"diameter_mm": 12, "length_mm": 6}]}],
  "machine": {"kinematics": "tool-vector"}})";
inline constexpr std::uint32_t kRackTools = 11;

/// The block for these kinds of rays and motions, as in a scene.
inline std::string rack_scene(const char* rays, const char* motion) {
  std::string scene = kRackScene;
  scene.replace(scene.find("RAYS"), 4, rays);
  scene.replace(scene.find("MOTION"), 6, motion);
  return scene;
}

}  // namespace kerf
