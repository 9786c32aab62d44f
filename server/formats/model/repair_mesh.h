// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <expected>
#include <stop_token>
#include <string>

#include "kernel/dexel/triangle_mesh.h"

namespace kerf {

/// The changes of repair_mesh.
struct MeshRepair {
  std::size_t vertices_joined = 0;
  std::size_t triangles_dropped = 0;  ///< without area, or repeated
  std::size_t triangles_turned = 0;   ///< to agree with most of their shell
  std::size_t shells_turned = 0;      ///< that were inside out
  std::size_t holes_closed = 0;
  double longest_hole_mm = 0;  ///< length of the longest closed boundary
  friend bool operator==(const MeshRepair&, const MeshRepair&) = default;
};
/// Returns a repair as one clause, e.g. "closed 2 holes (the longest boundary: 12.3 mm), turned 1
/// shell", or an empty text if nothing was changed.
std::string to_string(const MeshRepair& repair);

/// Makes a mesh bound a solid (mesh_stock_fault), by this rule. A mesh that already does so stays
/// unchanged.
///   1. Vertices on open edges are joined to others that are closer than 1e-5 of the mesh's
///      diagonal.
///   2. Triangles without area and repeated triangles are dropped; pairs that face each other are
///      dropped whole.
///   3. A shell is a set of triangles connected across edges of exactly two triangles. All
///      triangles of a shell are oriented like the larger part of its area.
///   4. Every boundary of a shell is closed by triangles to the mean point of its edges.
///   5. A shell is turned if its volume is negative, unless it is a cavity: it is inside another
///      shell, and step 3 changed nothing in it.
/// Equal meshes give equal bytes. Errors, as one clause: a shell with one side only (a Moebius
/// strip), no enclosed volume, more shells in one another than a bounded time allows to compare, a
/// requested stop, which is polled before each step.
std::expected<MeshRepair, std::string> repair_mesh(TriangleMesh& mesh,
                                                   const std::stop_token& stop = {});

}  // namespace kerf
