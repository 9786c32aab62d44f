// SPDX-License-Identifier: Apache-2.0
// Names of settings and error codes on the wire and the command line.
#include "kernel/sculpture.h"

namespace kerf {

const char* to_string(Rays rays) { return rays == Rays::kTriDexel ? "tri-dexel" : "dexel"; }

const char* to_string(SculptureErrorCode code) {
  switch (code) {
    using enum SculptureErrorCode;
    case kBadStock:
      return "bad_stock";
    case kBadPitch:
      return "bad_pitch";
    case kTooManyColumns:
      return "too_many_columns";
    case kBadTolerance:
      return "bad_tolerance";
    case kBadForce:
      return "bad_force";
    case kBadObstacle:
      return "bad_obstacle";
    case kUnknownTool:
      return "unknown_tool";
    case kBadTool:
      return "bad_tool";
    case kNotFinite:
      return "not_finite";
    case kBadAxis:
      return "bad_axis";
    case kTurnTooLarge:
      return "turn_too_large";
    case kOutOfRange:
      return "out_of_range";
    case kBadDuration:
      return "bad_duration";
    case kTooManySubMotions:
      return "too_many_sub_motions";
    case kStopped:
      return "stopped";
  }
  return "unknown";
}

}  // namespace kerf
