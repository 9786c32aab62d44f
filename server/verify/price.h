// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "server/formats/program.h"
#include "server/formats/scene.h"
#include "server/platform/clock.h"
#include "server/platform/page_faults.h"

namespace kerf {

/// Cost of a scene's block, measured on a carved sample.
struct Price {
  double us_per_motion = 0;  ///< CPU time of a motion with its force, on this machine now, with the
                             ///< first access to the memory of a new block
  double bytes = 0;          ///< of the block when all motions are carved
  std::size_t motions = 0;   ///< carved for the measurement
};

/// Measures a sample. A test supplies other functions.
struct CostMeter {
  std::function<double()> cpu_s = Clock::thread_cpu_s;  ///< CPU time of this thread
  std::function<std::int64_t()> page_faults = PageFaults::of_thread;
  std::function<double()> page_fault_s = PageFaults::cpu_s_each;
};

/// Carves a program in a block of the scene if that takes about 1.5 s of CPU time at most,
/// estimated from short windows; otherwise long windows that are spread evenly over it and take as
/// long. Memory grows with the tiles that the motions reach, which are counted for all of them. The
/// scene keeps none of it.
Price price_of_program(const Scene& scene, std::span<const ProgramMotion> motions,
                       const CostMeter& meter = {});

/// Like price_of_program for a hand that carves the whole block: strokes of 1 mm with the largest
/// tool, a third of its radius deep, that turn by 2.5 degrees if the machine can turn it.
Price price_of_hand(const Scene& scene, const CostMeter& meter = {});
/// The strokes of price_of_hand.
std::vector<ProgramMotion> sample_hand(const Scene& scene);

}  // namespace kerf
