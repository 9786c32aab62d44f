// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kernel/sculpture.h"
#include "server/wire/control.h"

namespace kerf {

/// Why a peer's request was not carried out: goes to that peer alone, and changes nothing for the
/// others.
struct Rejection {
  wire::ErrorCode code = wire::ErrorCode::kBadMessage;
  std::string reason;  ///< one sentence
};

/// What the sculpture rejected, in the words of the protocol.
Rejection to_rejection(const SculptureError& error);

}  // namespace kerf
