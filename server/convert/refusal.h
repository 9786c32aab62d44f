#pragma once

#include <string>

#include "kernel/sculpture.h"
#include "server/wire/control.h"

namespace kerf {

/// Why a peer's request was not carried out: goes to that peer alone, and changes nothing for the
/// others.
struct Refusal {
  wire::ErrorCode code = wire::ErrorCode::kBadMessage;
  std::string reason;  ///< one sentence
};

/// What the sculpture refused, in the words of the protocol.
Refusal to_refusal(const SculptureError& error);

}  // namespace kerf
