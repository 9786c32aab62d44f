// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "haptic_agent/realtime/spsc_ring.h"
#include "server/wire/types.h"

namespace kerf::agent {

/// Samples from the servo thread to the link thread or the replica thread. The reader may fall
/// behind by one second at 1 kHz. A sample that finds the ring full is dropped. The next one then
/// ends a longer motion.
using SampleRing = SpscRing<wire::MotionSample, 1024>;

}  // namespace kerf::agent
