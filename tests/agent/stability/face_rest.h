// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "tests/agent/stability/plant.h"
#include "tests/agent/stability/virtual_line.h"

namespace kerf::agent {

/// A tool as named in scenes.
struct FaceTool {
  const char* name;
  const char* json;  ///< members of the tool, without its id
};
/// Tools that touch a face with an area, a rim, a point or an edge.
inline constexpr std::array<FaceTool, 10> kFaceTools = {
    {{"flat 6", R"("shape":"flat","diameter_mm":6,"length_mm":40)"},
     {"flat 12", R"("shape":"flat","diameter_mm":12,"length_mm":40)"},
     {"flat 20", R"("shape":"flat","diameter_mm":20,"length_mm":40)"},
     {"bull nose 8", R"("shape":"bull_nose","diameter_mm":8,"corner_radius_mm":2,"length_mm":40)"},
     {"bull nose 16",
      R"("shape":"bull_nose","diameter_mm":16,"corner_radius_mm":3,"length_mm":40)"},
     {"ball 6", R"("shape":"ball","diameter_mm":6,"length_mm":40)"},
     {"taper 3", R"("shape":"taper","diameter_mm":3,"half_angle_deg":6,"length_mm":40)"},
     {"cone end 6", R"("shape":"cone_end","diameter_mm":6,"tip_angle_deg":120,"length_mm":40)"},
     {"apt 10",
      R"("shape":"apt","d_mm":10,"r_mm":1.5,"e_mm":3.630717035815369,"f_mm":2.0250053615596113,)"
      R"("alpha_deg":8,"beta_deg":6,"h_mm":40)"},
     {"T-slot 8", R"("shape":"profile","profile_mm":[[0,0],[4,0],[4,2],[1.5,2],[1.5,40]])"}}};

/// Settings: a hand holds a tool at an angle, presses it slowly onto a face and rests.
struct FaceRest {
  PlantMechanics mechanics{};
  LineQuality line{};
  std::size_t tool = 0;   ///< index in kFaceTools
  double tilt_rad = 0;    ///< from +z to the axis held by the hand, about y
  bool obstacle = false;  ///< the face of an obstacle, which only the server knows; else stock
  double depth_mm = 4;    ///< depth of the hand's target below the face
};
struct FaceRestOutcome {
  double returned_mj = 0;       ///< greatest over any interval, in the plant
  double buzz_mm_per_s = 0;     ///< rms speed of the tip in the last half second
  double moved_at_rest_mm = 0;  ///< between the ends of that half second
  double given_at_rest_mj = 0;  ///< work of the device on the hand during it
  double force_n = 0;           ///< acting force at the end
  std::uint64_t trips = 0;
};
/// Observes the hand until its own oscillations would have died out: seven time constants of the
/// slower of its two, at most 12 s.
FaceRestOutcome rest_on_face(const FaceRest& rest);
/// Returns random settings: one of ten tools, tilt 0 to 0.5 rad, damping ratio 0.1 to 1, wrist 20
/// to 1340 N mm/rad, hand 0.05 to 2 kg and 0.02 to 2 N/mm, device of 1e-5 to 1e-3 kg m² with 0, 1
/// or 3 ms, pressed 0.5 to 6 mm deep on stock or an obstacle, round trip up to 50 ms.
FaceRest random_face_rest(std::uint32_t seed);

}  // namespace kerf::agent
