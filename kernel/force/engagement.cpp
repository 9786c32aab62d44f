// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/engagement.h"

#include <algorithm>

namespace kerf {

Engagement& Engagements::follow(std::uint32_t tool, const ToolPose& from, const ToolPose& to) {
  const auto last = std::find_if(users_.rbegin(), users_.rend(),
                                 [&](const User& u) { return u.tool == tool && u.at == from; });
  if (last == users_.rend()) {
    if (users_.size() == kUsersMax) users_.erase(users_.begin());
    users_.push_back({tool, to, Engagement(pitch_mm_)});
  } else {
    std::rotate(last.base() - 1, last.base(), users_.end());
    users_.back().at = to;
  }
  return users_.back().engagement;
}

void Engagements::forget(std::uint32_t tool) {
  std::erase_if(users_, [tool](const User& u) { return u.tool == tool; });
}

}  // namespace kerf
