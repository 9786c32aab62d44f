// SPDX-License-Identifier: Apache-2.0
#pragma once

// Every rounding allowance of the kernel, with its unit, its owner and what breaks if it grows. A
// *tolerance* is what the user asks for (SculptureSettings::tolerance_mm); what stands here is
// *epsilon*: rounding, never geometry.

namespace kerf {

/// mm. Intersection points this far outside the end of a generator or a swept segment still count,
/// so that a ray through an edge is claimed by at least one of the surfaces that meet there. Owner:
/// intersect, sweep. If it grows, tools grow.
inline constexpr double kEdgeEpsilonMm = 1e-9;

/// Dimensionless. Sines below it are directions that cannot be told from parallel. Owner:
/// tool_motion. If it grows, slow turns are dropped.
inline constexpr double kParallelEpsilon = 1e-12;

/// mm. A tip that moves less than this between two poses is at rest. Owner: tool_motion. If it
/// grows, slow motions cut nothing until they add up.
inline constexpr double kRestEpsilonMm = 1e-12;

/// Dimensionless. A tip displacement within this sine of the tool axis is an axial motion (paper
/// section 2.4, case 1). Owner: tool_motion. Only the force direction depends on it (Eq. 20 against
/// Eq. 22, equal there up to the sign).
inline constexpr double kAxialSine = 1e-3;

/// Dimensionless. When the tip's path is shorter than this part of the path of the point one radius
/// up the axis, the motion counts as a rotation (paper section 2.4, case 2). Owner: tool_motion.
/// Only the force direction depends on it.
inline constexpr double kRotationShare = 1e-2;

}  // namespace kerf
