// SPDX-License-Identifier: Apache-2.0
#include "server/convert/rejection.h"

namespace kerf {

Rejection sample_rejection(const wire::MotionSample& sample, wire::ErrorCode code,
                           const std::string& reason) {
  return {code, "sample " + std::to_string(sample.agent_sequence) + ": " + reason};
}

Rejection unknown_tool(ToolId tool) {
  return {wire::ErrorCode::kUnknownTool, "the session has no tool " + std::to_string(tool)};
}

Rejection to_rejection(const SculptureError& error) {
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
