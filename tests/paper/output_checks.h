// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "kernel/dexel/triangle_mesh.h"
#include "kernel/sculpture.h"

namespace kerf::paper {

/// Returns the carved bird, carved once.
Sculpture& carved_bird();
/// Returns the bird as an STL file, written and read back: Fig. 15 (c).
std::shared_ptr<const TriangleMesh> bird_stl();
/// The brush, carved by hand and from the NC program written from it: Fig. 17 (c).
struct Replay {
  Sculpture by_hand, from_nc;
  std::size_t lines = 0, motions = 0;
};
Replay& replayed_brush();

}  // namespace kerf::paper
