// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace kerf {

enum class PinFault : std::uint8_t {
  kUnknown,     ///< there is no pin of that number
  kLimit,       ///< the session has kPinsMax
  kNotAllowed,  ///< it is another's
  kPaused       ///< the journal cannot be written
};
/// Why a pin was not set or removed; one sentence.
struct PinError {
  PinFault fault = PinFault::kUnknown;
  std::string reason;
};

}  // namespace kerf
