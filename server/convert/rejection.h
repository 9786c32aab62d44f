// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kernel/sculpture.h"
#include "server/wire/control.h"

namespace kerf {

/// The error of a request of a peer. It is sent to that peer only; the request had no effect.
struct Rejection {
  wire::ErrorCode code = wire::ErrorCode::kBadMessage;
  std::string reason;  ///< one sentence
};

/// Converts an error of the sculpture to an error of the protocol.
Rejection to_rejection(const SculptureError& error);

}  // namespace kerf
