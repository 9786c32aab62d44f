// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace kerf {

/// The kind of an error: it decides the HTTP status (server/http).
enum class ErrorKind : std::uint8_t {
  kInvalid,     ///< the request is malformed
  kNotAllowed,  ///< the caller lacks the right
  kUnknown,     ///< the named item does not exist
  kConflict,    ///< the item exists already, or a limit is reached
  kBusy,        ///< the same request may succeed later
  kFailed       ///< the server cannot do it
};

/// Why a request about a block failed.
struct Error {
  ErrorKind kind = ErrorKind::kInvalid;
  const char* code = "";  ///< for programs, e.g. "unknown_pin"
  std::string reason;     ///< for people: one sentence
};

}  // namespace kerf
