// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kerf::agent {

/// Result of a check. kNote: something that may concern the user but is no fault. kWarning: the
/// agent works, but not as well as it could. kBad: a requested function does not work.
enum class Health { kFine, kNote, kWarning, kBad };

struct Finding {
  Health health = Health::kFine;
  /// One sentence.
  std::string what{};
  /// Remedy, one step per line. May be empty.
  std::vector<std::string> advice{};
};

}  // namespace kerf::agent
