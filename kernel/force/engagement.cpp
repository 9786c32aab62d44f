// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/engagement.h"

#include <algorithm>

namespace kerf {

Engagement& Engagements::follow(std::uint32_t tool, const ToolPose& from, const ToolPose& to) {
  const auto last = std::find_if(hands_.rbegin(), hands_.rend(),
                                 [&](const Hand& h) { return h.tool == tool && h.at == from; });
  if (last == hands_.rend()) {
    if (hands_.size() == kHandsMax) hands_.erase(hands_.begin());
    hands_.push_back({tool, to, Engagement(pitch_mm_)});
  } else {
    std::rotate(last.base() - 1, last.base(), hands_.end());
    hands_.back().at = to;
  }
  return hands_.back().engagement;
}

void Engagements::forget(std::uint32_t tool) {
  std::erase_if(hands_, [tool](const Hand& h) { return h.tool == tool; });
}

}  // namespace kerf
