// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kerf::agent {

/// How a check went. A warning: the agent works, and not as well as it could.
enum class Health { kFine, kWarning, kBad };

struct Finding {
  Health health = Health::kFine;
  /// One sentence.
  std::string what{};
  /// What to do, one step a line; empty where nothing need be done.
  std::vector<std::string> advice{};
};

}  // namespace kerf::agent
