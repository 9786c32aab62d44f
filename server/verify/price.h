// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "server/formats/program.h"
#include "server/formats/scene.h"
#include "server/platform/clock.h"

namespace kerf {

/// What the block of a scene costs, measured on a sample that is carved.
struct Price {
  double us_per_motion = 0;  ///< CPU time of a motion with its force, on this machine now
  double bytes = 0;          ///< of the block's columns when all motions are carved
  std::size_t motions = 0;   ///< that were carved for it
};

/// Returns the CPU time of this thread, s. A test gives another clock.
using CpuClock = std::function<double()>;

/// Carves a program in a block of the scene if that takes some 1.5 s of CPU time at most, by an
/// estimate from short windows, else long windows that are spread evenly over it and take as long.
/// Memory grows with the tiles that the motions reach, which are counted for all of them. Nothing
/// of it is kept in a scene.
Price price_of_program(const Scene& scene, std::span<const ProgramMotion> motions,
                       const CpuClock& now = Clock::thread_cpu_s);

/// The same of a hand that carves the whole block: strokes of 1 mm with the largest tool, a third
/// of its radius deep, that turn by 2.5 degrees where the machine can turn it.
Price price_of_hand(const Scene& scene, const CpuClock& now = Clock::thread_cpu_s);
/// The strokes that it carves.
std::vector<ProgramMotion> sample_hand(const Scene& scene);

}  // namespace kerf
