// SPDX-License-Identifier: Apache-2.0
#include "kernel/force/engagement.h"

#include <algorithm>

namespace kerf {

Engagements::Followed Engagements::follow(std::uint32_t tool, const ToolPose& from,
                                          const ToolPose& to, bool felt) {
  const auto last = std::find_if(users_.rbegin(), users_.rend(),
                                 [&](const User& u) { return u.tool == tool && u.at == from; });
  const bool continues = last != users_.rend();
  if (!continues) {
    if (users_.size() == kUsersMax) users_.erase(users_.begin());
    users_.push_back({tool, to, fresh(), felt});
  } else {
    std::rotate(last.base() - 1, last.base(), users_.end());
    User& user = users_.back();
    user.at = to;
    if (!felt && user.pending) user.engagement = fresh();
    user.pending = felt;
  }
  return {users_.back().engagement, continues};
}

void Engagements::forget(std::uint32_t tool) {
  std::erase_if(users_, [tool](const User& u) { return u.tool == tool; });
}

std::vector<ToolUser> Engagements::users() const {
  std::vector<ToolUser> users;
  users.reserve(users_.size());
  for (const User& user : users_) users.push_back({user.tool, user.at});
  return users;
}

void Engagements::restore(std::span<const ToolUser> users) {
  users_.clear();
  for (const ToolUser& user : users.last(std::min(users.size(), kUsersMax))) {
    users_.push_back({user.tool, user.at, fresh(), false});
  }
}

}  // namespace kerf
