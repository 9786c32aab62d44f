// SPDX-License-Identifier: Apache-2.0
#pragma once

// Errors of Sculpture::create, apply and check.

#include <string>

namespace kerf {

enum class SculptureErrorCode {
  kBadStock,           ///< not finite, empty, too thin, out of range, or a mesh that is not closed
  kBadPitch,           ///< pitch_mm out of range
  kTooManyColumns,     ///< the stock needs more columns than a field may have
  kBadTolerance,       ///< tolerance_mm out of range
  kBadForce,           ///< a force setting is negative or not finite
  kBadObstacle,        ///< an obstacle is empty, not finite, or has no positive stiffness
  kUnknownTool,        ///< a motion of a tool that is not defined
  kBadTool,            ///< the pieces of a tool are inconsistent or out of range
  kNotFinite,          ///< a pose holds an infinite, NaN or denormal number
  kBadAxis,            ///< the length of a tool axis is not within [0.5, 2]
  kTurnTooLarge,       ///< a motion turns the axis by more than kTurnMaxRad
  kOutOfRange,         ///< a tool tip is beyond kCoordinateMaxMm
  kBadDuration,        ///< duration_s is negative, not finite or denormal
  kTooManySubMotions,  ///< a motion would be divided into more than 2^20 cuts
  kStopped,            ///< a stop was asked
};

struct SculptureError {
  SculptureErrorCode code;
  std::string reason;  ///< one sentence that names the field and the limit
};

/// Returns the name of a code as the wire protocol and the command line write it, for example
/// "turn_too_large".
const char* to_string(SculptureErrorCode code);

}  // namespace kerf
