// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "server/rights/role.h"
#include "server/store/resume_token.h"

namespace kerf {

/// What a token gives its holder: a role in one session, until it expires or is revoked. An
/// invitation is made by an owner and may be passed on; a pass is what a browser gets for an
/// invitation, and ends with it.
struct Grant {
  std::string id;  ///< public: it names the grant in lists and in its token
  std::string session;
  Role role = Role::kWatcher;
  std::string invitation;                     ///< of a pass: the invitation that it was given for
  std::string name, color;                    ///< of the person; empty: not said
  std::int64_t created_s = 0, expires_s = 0;  ///< seconds since 1970; expires_s 0: never
  bool muted = false;
  /// Of an invitation: passes that it gives, 0: Access::kPassesMax, and that it has given so far,
  /// also to those who were removed.
  std::int64_t uses = 0, used = 0;
  TokenHash hash{};

  friend bool operator==(const Grant&, const Grant&) = default;
  bool is_pass() const { return !invitation.empty(); }
  /// Whether it belongs to one person, so that what happens to that person lasts: a pass, or an
  /// invitation by name.
  bool is_personal() const { return is_pass() || !name.empty(); }
};

}  // namespace kerf
