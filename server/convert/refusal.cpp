#include "server/convert/refusal.h"

namespace kerf {

Refusal to_refusal(const SculptureError& error) {
  using enum SculptureErrorCode;
  switch (error.code) {
    case kTurnTooLarge:
      return {wire::ErrorCode::kTurnTooLarge, error.reason};
    case kUnknownTool:
      return {wire::ErrorCode::kUnknownTool, error.reason};
    case kNotFinite:
    case kBadAxis:
    case kOutOfRange:
      return {wire::ErrorCode::kBadPose, error.reason};
    default:
      return {wire::ErrorCode::kMotionRefused, error.reason};
  }
}

}  // namespace kerf
