// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "haptic_agent/servo/felt.h"
#include "tests/agent/stability/plant.h"

namespace kerf::agent {

/// Strokes of hands. A rate is in Hz for the first four and in mm/s for the last two.
enum class Stroke : std::uint8_t {
  kPecking,     ///< down and up by 3 mm, 2 mm of it in the stock, drifting to the side by 2 mm/s
  kStippling,   ///< the same, 0.5 mm deep, each time at a new position
  kHatching,    ///< to and fro along x, 1 mm deep, drifting along y by 3 mm/s
  kTrochoidal,  ///< circles of 2 mm radius, 1 mm deep, drifting along x by 3 mm/s
  kDrilling,    ///< along the tool's axis, 3 mm deep
  kSlotting,    ///< along x, 1 mm deep, after a plunge
};
inline constexpr Stroke kStrokes[] = {Stroke::kPecking,    Stroke::kStippling, Stroke::kHatching,
                                      Stroke::kTrochoidal, Stroke::kDrilling,  Stroke::kSlotting};
const char* name_of(Stroke stroke) noexcept;
/// Typical rates of hands: 0.5 to 5 Hz, or 1 to 40 mm/s.
std::span<const double> rates_of(Stroke stroke) noexcept;

/// The tools as JSON of a scene without "id".
inline constexpr const char* kStrokeTools[] = {
    R"("shape":"ball","diameter_mm":6,"length_mm":40)",
    R"("shape":"flat","diameter_mm":6,"length_mm":40)",
    R"("shape":"bull_nose","diameter_mm":6,"corner_radius_mm":1,"length_mm":40)",
    R"("shape":"taper","diameter_mm":3,"half_angle_deg":8,"length_mm":30)",
    R"("shape":"cone_end","diameter_mm":6,"tip_angle_deg":90,"length_mm":40)",
    R"("shape":"apt","d_mm":6,"r_mm":1,"e_mm":2,"f_mm":1,"alpha_deg":0,"beta_deg":0,"h_mm":40)",
    R"("shape":"ball","diameter_mm":2,"length_mm":30)",
    R"("shape":"flat","diameter_mm":2,"length_mm":30)",
    R"("shape":"ball","diameter_mm":10,"length_mm":40)",
    R"("shape":"profile","profile_mm":[[0,0],{"to":[2,2],"center":[0,2]},[1,4],[1,30]])"};

/// Settings: a hand cuts a stroke into a block. The force is 1 N in a plunge of 1 mm² with any
/// tool, or that of a scene.
struct StrokeCut {
  Stroke stroke = Stroke::kPecking;
  double rate = 3;
  std::size_t tool = 0;  ///< index in kStrokeTools
  double tilt_rad = 0;   ///< tilt of the tool's axis about y
  double seconds = 3;
  double newtons = 1;  ///< approximately the greatest force of the stroke
  const char* rays = "dexel";
  /// A hand that the force moves. If empty, the hand is rigid.
  std::optional<PlantMechanics> live = std::nullopt;
  double quantum_mm = 0;  ///< for a rigid hand
};
struct StrokeOutcome {
  /// Shown wrench (for a live hand: acting wrench) against the server's result for the pose of that
  /// tick.
  FeltSums force, torque;
  /// The server's results one tick late, against the same.
  FeltSums late_force, late_torque;
  double soft_share = 0;     ///< share of the ticks in which the coupling of the cut was soft
  double reduced_share = 0;  ///< share of the ticks with a force in which it was reduced
  double returned_mj = 0;    ///< by a live hand's device, over any interval
  std::uint64_t trips = 0;
};
StrokeOutcome cut_stroke(const StrokeCut& cut);

}  // namespace kerf::agent
