// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kernel/sculpture.h"
#include "server/wire/control.h"
#include "server/wire/types.h"

namespace kerf {

/// The error of a peer's request. It is sent to that peer only, and the request had no effect.
struct Rejection {
  wire::ErrorCode code = wire::ErrorCode::kBadMessage;
  std::string reason;  ///< one sentence
};

/// Returns the rejection of one sample; prefixes the reason with the sample's number.
Rejection sample_rejection(const wire::MotionSample& sample, wire::ErrorCode code,
                           const std::string& reason);
/// Returns the rejection of a tool that the session does not have.
Rejection unknown_tool(ToolId tool);
/// Returns the rejection of a command by a muted participant.
inline Rejection muted_rejection() {
  return {wire::ErrorCode::kMuted, "an owner has muted this participant"};
}
/// Converts an error of the sculpture to an error of the protocol.
Rejection to_rejection(const SculptureError& error);

}  // namespace kerf
