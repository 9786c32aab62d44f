// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <variant>
#include <vector>

namespace kerf {

// The shapes a user can define. Lengths in mm, measured from the tip along the axis; angles in
// degrees.

struct BallShape {
  double diameter_mm, length_mm;  ///< length >= diameter / 2
};
struct FlatShape {
  double diameter_mm, length_mm;
};
/// A cylinder with a rounded lower edge. A corner of 0 makes it flat, a corner of half the diameter
/// a ball.
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
/// The cutter of APT's CUTTER/d,r,e,f,alpha,beta,h, in the half-plane (radius, height). A bottom
/// line rises outwards from the tip at `alpha` to the horizontal, and a side line leans away from
/// the axis by `beta`. Both meet at the radius d/2, and an arc of radius r about (e, f) joins them.
/// The arc is tangent to a line or is cut off by it. A negative e makes a barrel.
struct AptShape {
  double d_mm;       ///< diameter where bottom and side line meet, > 0
  double r_mm;       ///< corner radius; 0 makes a sharp corner, and (e, f) is where the lines meet
  double e_mm;       ///< distance of the arc's center from the axis, < 0 beyond the axis
  double f_mm;       ///< height of the arc's center
  double alpha_deg;  ///< in [0, 90)
  double beta_deg;   ///< in (-90, 90)
  double h_mm;       ///< height of the cutter
};
/// A point of an outline in the half-plane (r, h): distance from the axis and height above the tip.
struct ProfilePoint {
  double r_mm, h_mm;
};
/// Whether an arc bulges away from the axis (a rounded edge) or towards it (a fillet).
enum class ArcBulge { kOut, kIn };
/// An arc of at most half a circle from the previous point to `to`.
struct ProfileArc {
  ProfilePoint to;
  double radius_mm;
  ArcBulge bulge = ArcBulge::kOut;
};
struct ProfileCenteredArc {
  ProfilePoint to;
  ProfilePoint center;  ///< equally far from both ends, to 0.001 mm
  ArcBulge bulge = ArcBulge::kOut;
};
/// One step of an outline: a straight line to a point, or an arc.
using ProfileStep = std::variant<ProfilePoint, ProfileArc, ProfileCenteredArc>;

/// mm. Default and limits of ProfileShape::chord_tolerance_mm.
inline constexpr double kChordToleranceMm = 0.0001;
inline constexpr double kChordToleranceMinMm = 0.000001, kChordToleranceMaxMm = 1;

/// A free outline from the tip up: lollipops, dovetails, T-slot and form cutters. The first step is
/// a point at height 0, on the axis or off it. Heights never fall; equal heights make a shoulder.
/// Arcs that bulge out are exact. Arcs that bulge in are divided into straight sections that touch
/// the arc from inside the tool, at most chord_tolerance_mm off, so the tool never removes material
/// that the true tool would leave.
struct ProfileShape {
  std::vector<ProfileStep> steps;
  double chord_tolerance_mm = kChordToleranceMm;
};
using ToolShape = std::variant<BallShape, FlatShape, TaperShape, ConeEndShape, BullNoseShape,
                               AptShape, ProfileShape>;

/// Returns the height of the cutting part. The shape must be one that make_tool accepts.
double cutting_length_mm(const ToolShape& shape);

/// A cylinder that begins at the end of the cutting length.
struct Shank {
  double diameter_mm, length_mm;
};
/// A cylinder, or a frustum that opens or closes upwards.
struct HolderSection {
  double diameter_mm, top_diameter_mm, length_mm;
};
/// Sections stacked from below, or an outline whose heights count from the holder's lower end.
using Holder = std::variant<std::vector<HolderSection>, ProfileShape>;
/// The part of a tool above its cutting part. It does not cut, but collides.
struct ToolBody {
  std::optional<Shank> shank;
  std::optional<Holder> holder;  ///< above the shank
};

}  // namespace kerf
