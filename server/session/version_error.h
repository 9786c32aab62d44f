// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace kerf {

enum class VersionFault : std::uint8_t {
  kUnknown,     ///< there is no version of that name
  kTaken,       ///< there is one
  kNoRecord,    ///< the record is still to come
  kLimit,       ///< the session has kVersionsMax
  kNotAllowed,  ///< it is another's
  kPaused       ///< the journal cannot be written
};
/// Why a version was not named, renamed or deleted; one sentence.
struct VersionError {
  VersionFault fault = VersionFault::kUnknown;
  std::string reason;
};

}  // namespace kerf
