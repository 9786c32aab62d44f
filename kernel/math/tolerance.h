// SPDX-License-Identifier: Apache-2.0
#pragma once

// Every epsilon of the kernel: allowances for rounding, ends of iterations, and thresholds below
// which a case counts as degenerate. Each has its unit, its owner (the code that uses it) and the
// consequence of enlarging it. A *tolerance*, in contrast, is an accuracy that the user requests
// (SculptureSettings::tolerance_mm).

namespace kerf {

// --- Surfaces and motions (kernel/intersect, kernel/sweep) ---

/// mm. Intersection points this far outside the end of a generator or a swept segment still count,
/// so that a ray through an edge hits at least one of the surfaces that meet there. Owner:
/// intersect, sweep. If it grows, tools grow.
inline constexpr double kEdgeEpsilonMm = 1e-9;

/// Dimensionless. Directions whose angle has a smaller sine are parallel.
/// Owner: sweep/tool_motion. If it grows, slow turns are dropped.
inline constexpr double kParallelEpsilon = 1e-12;

/// mm. A tip that moves less than this between two poses is at rest.
/// Owner: sweep/tool_motion. If it grows, slow motions cut nothing until they add up.
inline constexpr double kRestEpsilonMm = 1e-12;

/// Dimensionless. A tip displacement within this sine of the tool axis is an axial motion (paper
/// section 2.4, case 1). Owner: sweep/tool_motion. If it grows, the force of slightly slanted
/// plunges points along the axis (Eq. 20 instead of Eq. 22).
inline constexpr double kAxialSine = 1e-3;

/// Dimensionless. When the tip's path is shorter than this part of the path of the point one radius
/// up the axis, the motion counts as a rotation (paper section 2.4, case 2).
/// Owner: sweep/tool_motion. If it grows, the force ignores the tip's path more often.
inline constexpr double kRotationShare = 1e-2;

/// mm². A ray whose squared distance from the axis exceeds that of a disc's rim by less passes the
/// rim, and its end may join that of a neighbor. Larger than the square of a joining distance for
/// any radius. Owner: sweep/slice_meeting. If it grows, only time is lost; at 0, seams may stay
/// open.
inline constexpr double kRimMm2 = 1e-5;

/// mm. Rays this far outside the rectangle that a surface covers still test the surface. Much
/// larger than kEdgeEpsilonMm and rounding. Owner: sweep/frustum_translation. If it grows, only
/// time is lost; if it shrinks to kEdgeEpsilonMm, hits at edges are lost.
inline constexpr double kRectangleMarginMm = 1e-6;

/// mm per motion. Least speed at which the surface of a tool counts as receding. The interval of
/// the last pose is then within that of the first pose by more than kEdgeEpsilonMm and all
/// rounding. Owner: sweep. If it grows, only time is lost; at 0, a block after an undo may differ
/// in a bit (kernel/sweep/bounds.md, "The last pose is removed").
inline constexpr double kRecedingMm = 4e-9;

/// mm of travel, times the root of the radius. A ball this near to the end of its path counts as
/// being there. Its end then errs by half the square of this over the radius. Owner:
/// intersect/ray_capsule. If it grows, ends of balls err by its square.
inline constexpr double kArrivalMm = 1e-5;

/// Share of a piece's height by which a clipped piece reaches out of the block, so that its new
/// upper disc stays clear of it. Owner: sweep/clip_to_block. If it grows, only time is lost.
inline constexpr double kClipMarginShare = 1e-3;

/// Relative. A neighbor whose radius is less by this share (and kEdgeEpsilonMm) still hides the
/// disc of a slice. Owner: sweep/swept_tool. If it grows, rims that stick out are not searched.
inline constexpr double kHiddenDiscShare = 1e-12;

/// mm. A disc of a smaller radius is the tip of a slice, where the side ends without an edge.
/// Owner: sweep/piece_side, sweep/swept_tool. If it grows, small rims are not searched.
inline constexpr double kTipMm = 1e-9;

/// Squared sine of the axis' lean from which on a plane along the axis bounds a piece better than a
/// level one. Owner: sweep/shadow. If it grows, only time is lost; at 0, the plane's normal is 0/0.
inline constexpr double kPlaneLean2 = 1e-4;

/// mm. Bounds below a turning tool are computed at as many poses (up to five) as keep the deviation
/// in between below this. Owner: sweep/underside. If it grows, bounds are lower, and time is lost.
inline constexpr double kUndersideSlackMm = 1e-3;

/// Dimensionless. Smaller components of the axis along the rays are replaced by this, so that a ray
/// perpendicular to the axis crosses the planes of the discs at a finite, huge distance. Owner:
/// sweep/slice_meeting. If it grows by orders of magnitude, discs end rays that never cross them.
inline constexpr double kAxisAlongRayMin = 1e-290;

/// mm. Newton's method along a ray has reached an arc when it is this near to it.
/// Owner: sweep/piece_side. If it grows, ends on arcs err by it over the sine of the grazing angle.
inline constexpr double kArcFoundMm = 1e-11;

/// Squared length of a step along a ray, relative to the distance from the axis, up to which the
/// bound of the step's error is taken at its start. Owner: sweep/piece_side. If it grows to the
/// order of 1, steps near the axis of an arc end too early, and ends on arcs err.
inline constexpr double kArcShortStep2 = 1e-4;

/// Sine of the angle between a ray and a side up to which the ray's closest point counts as found.
/// Owner: sweep/miss_reach. If it grows, the tilt of a supporting plane cannot compensate for it.
inline constexpr double kFlatSlope = 1e-5;

/// mm along the ray. A ray that misses an arc is closest to it somewhere in an interval of this
/// width; the gap errs by its square over a radius. Owner: sweep/piece_side. If it grows, gaps are
/// overestimated, and rays are given up that the arc still reaches.
inline constexpr double kArcClosestMm = 1e-5;

/// Squared sine of the angle between a displacement and the rays below which it is along them.
/// Owner: intersect/ray_contour. If it grows, contours of steep plunges are lost.
inline constexpr double kAlongRays2 = 1e-24;

/// Greatest sine on the contour of an arc: at the pole, where its tangent may be undefined, it is
/// continued by kPoleMarginMm. Owner: intersect/ray_contour. If it falls, ends near the pole err.
inline constexpr double kPoleSine = 1 - 1e-15;

/// mm. A ray this far beyond the last point of a contour at its pole meets that point. More than
/// the part that kPoleSine leaves out, 5e-8 radii.
/// Owner: intersect/ray_contour. If it grows, ends near the pole err by its square over a radius.
inline constexpr double kPoleMarginMm = 1e-5;

/// mm. Distance from the outermost end at which the search stops in convex sweeps without a turn,
/// independent of the user's tolerance. Owner: sweep/swept_tool. If it grows, translated arcs are
/// cut too shallow by it.
inline constexpr double kTranslationSearchMm = 1e-9;

/// mm. A point this near to a piece is on it, and no other piece is tested.
/// Owner: sweep/swept_surface. If it grows, ends near a seam get the normal of the wrong piece.
inline constexpr double kOnSurfaceMm = 1e-6;

/// mm of travel. The search for the pose that touches a point ends in an interval of this length;
/// the normal errs by its ratio to the tool's radius there. Owner: sweep/swept_surface. If it
/// grows, normals err.
inline constexpr double kTouchSearchMm = 1e-6;

// --- Definitions of tools (kernel/tool) ---

/// mm. Sections of an outline that rise by less are shoulders. Points count as on the axis, and
/// lines as tangent, if they miss by less. Owner: tool. If it grows, thin parts of a profile are
/// lost.
inline constexpr double kOutlineEpsilonMm = 1e-9;

/// mm. Lines and arcs of a definition count as meeting if they miss by less, because cutter data is
/// rounded to three decimals. Owner: tool. If it grows, inconsistent definitions are accepted.
inline constexpr double kMissAllowanceMm = 1e-3;

// --- Force (kernel/force) ---

/// mm. Pieces of a tool form one convex part where their union is convex within this much: twice
/// kMissAllowanceMm, so that outlines rounded to 0.001 mm do not come apart. Owner:
/// tool/convex_part. If it grows, contact begins earlier in the corners of outlines.
inline constexpr double kHullAllowanceMm = 2e-3;
/// mm. Corners of an outline that protrude by less are left out. Owner: tool/convex_part. If it
/// grows, contacts become shallower.
inline constexpr double kStraightMm = 1e-6;

/// mm. Radii that differ by less are equal, and pieces whose heights differ by less adjoin. Owner:
/// force/surface_weight. If it grows, narrow shoulders get no weight.
inline constexpr double kCoverEpsilonMm = 1e-9;

/// Dimensionless. If the displacements of a tool's points differ by less than this share of the
/// tip's, all elements push in the direction of their middle. Owner: force/cut_sum. If it grows,
/// directions err by its square, and the torque by it times the spread of the elements.
inline constexpr double kCommonDirectionShare = 1e-3;

/// Dimensionless. A path shorter than this share of the kernel's width counts as a point, because
/// the difference quotient over it would be dominated by rounding. Owner: force/travel_queue. If it
/// grows, the force of short motions is delivered in steps.
inline constexpr double kPointShare = 1e-5;

/// mm per tooth. Below this feed the edge forces of the mechanistic law fade to zero, and the
/// coefficient of a chip (Kienzle's is unbounded at 0) no longer grows. It only separates rest from
/// motion. Owner: force/milling_elements, force/milling_force. If it grows, slow cuts of fine edges
/// lose force (kernel/force/mechanistic.md, "Small feeds").
inline constexpr double kRestFeedMm = 0.00005;

/// mm. A depth counts as found when it is missed by less. Owner: force/stock_contact. If it grows,
/// contacts become shallower.
inline constexpr double kDepthEpsilonMm = 1e-7;

// --- Mesh (kernel/surface) ---

/// Dimensionless. The upright component of a normal is raised to this where a plane is intersected
/// along the rays. Owner: surface/level_guess. If it grows, steep walls are met too early.
inline constexpr double kUprightMin = 1e-4;

/// Share of a squared secant. Rounding of the normals' codes hides an ellipse whose third
/// difference of heights (in pitches) is smaller. Owner: surface/edge_slice. If it grows, ellipses
/// become lines.
inline constexpr double kThirdOfSecant = 1e-3;

/// Weight of the crossings' mean relative to that of a plane. It determines the position along a
/// ridge, which no plane does. Owner: surface/sheet_point. If it grows, ridges sink; if it shrinks,
/// vertices wander along them.
inline constexpr double kMeanWeight = 3e-4;

/// Dimensionless. Sines below which both diagonals of a quadrangle fit the surface equally well.
/// Owner: surface/tile_mesh. If it grows, the shorter diagonal is used against the surface.
inline constexpr double kFitEpsilon = 1e-4;

/// Pitches. A flat floor may pass the end of its lattice edge by this, so that rounding does not
/// split floors at a sample's height; other triangles stay this far from the end. Owner:
/// surface/quad_split. If it grows, triangles of neighboring edges may intersect.
inline constexpr double kEnvelopeSlack = 1e-9;

/// Dimensionless. A sum of unit normals shorter than this has no direction.
/// Owner: surface/vertex_placement. If it grows, thin walls are shaded upright.
inline constexpr double kNormalMin = 1e-6;

}  // namespace kerf
