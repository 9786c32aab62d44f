// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "server/store/journal_error.h"

namespace kerf {

/// Returns why a paused session accepts no motions: "paused: lease: REASON" or "paused: disk:
/// REASON".
inline std::string pause_text(const JournalError& error) {
  return std::string("paused: ") + pause_word(error.code) + ": " + error.reason;
}

}  // namespace kerf
