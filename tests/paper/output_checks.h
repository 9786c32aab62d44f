// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "kernel/dexel/triangle_mesh.h"
#include "kernel/sculpture.h"

namespace kerf::paper {

/// The carved bird, made once.
Sculpture& carved_bird();
/// The bird as an STL file, written and read again: Fig. 15 (c).
std::shared_ptr<const TriangleMesh> bird_stl();
/// The brush: carved by hand, and from the NC program that was written of it: Fig. 17 (c).
struct Replay {
  Sculpture by_hand, from_nc;
  std::size_t lines = 0, motions = 0;
};
Replay& replayed_brush();

}  // namespace kerf::paper
