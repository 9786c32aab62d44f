#pragma once

#include <variant>

namespace kerf {

// The shapes a user can define. Lengths in mm, measured from the tip along the axis; angles in
// degrees.

struct BallShape {
  double diameter_mm, length_mm;  ///< length >= diameter / 2
};
struct FlatShape {
  double diameter_mm, length_mm;
};
/// A cylinder with a rounded lower edge. A corner of 0 makes it flat, one of half the diameter a
/// ball.
struct BullNoseShape {
  double diameter_mm;
  double corner_radius_mm;  ///< in [0, diameter / 2]
  double length_mm;         ///< >= corner radius
};
enum class TaperTip { kFlat, kBall };
struct TaperShape {
  double diameter_mm;     ///< at the tip (of the ball for TaperTip::kBall)
  double half_angle_deg;  ///< between axis and side, in (0, 90)
  double length_mm;
  TaperTip tip = TaperTip::kFlat;
};
struct ConeEndShape {
  double diameter_mm;
  double tip_angle_deg;  ///< included angle of the cone at the tip, in (0, 180)
  double length_mm;      ///< whole length, cone and cylinder
};
/// The cutter of APT's CUTTER/d,r,e,f,alpha,beta,h, seen in the half-plane (radius, height): a
/// bottom line rises outwards from the tip at `alpha` to the horizontal, a side line leans away
/// from the axis by `beta`, both meet at the radius d/2, and an arc of radius r about (e, f) joins
/// them. It touches the lines or is cut off by them. A negative e makes a barrel.
struct AptShape {
  double d_mm;       ///< diameter where bottom and side line meet, > 0
  double r_mm;       ///< corner radius; 0: a sharp corner, and (e, f) is where the lines meet
  double e_mm;       ///< distance of the arc's centre from the axis, < 0 beyond it
  double f_mm;       ///< height of the arc's centre
  double alpha_deg;  ///< in [0, 90)
  double beta_deg;   ///< in (-90, 90)
  double h_mm;       ///< height of the cutter
};
using ToolShape =
    std::variant<BallShape, FlatShape, TaperShape, ConeEndShape, BullNoseShape, AptShape>;

}  // namespace kerf
