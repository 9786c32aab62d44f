// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "server/rights/role.h"
#include "server/store/resume_token.h"

namespace kerf {

/// The rights of a token's holder: a role in one session, until it expires or is revoked. An owner
/// makes an invitation, which may be passed on. A browser exchanges it for a pass, which ends with
/// it.
struct Grant {
  std::string id;  ///< public: it names the grant in lists and in its token
  std::string session;
  Role role = Role::kWatcher;
  std::string invitation;                     ///< for a pass: its invitation
  std::string name, color;                    ///< of the person; empty: not stated
  std::int64_t created_s = 0, expires_s = 0;  ///< seconds since 1970; expires_s 0: never
  bool muted = false;
  /// For an invitation: its number of passes (0: Access::kPassesMax), and those given so far, also
  /// to removed people.
  std::int64_t uses = 0, used = 0;
  TokenHash hash{};

  friend bool operator==(const Grant&, const Grant&) = default;
  bool is_pass() const { return !invitation.empty(); }
  /// Whether it belongs to one person, so that decisions about that person last: a pass, or an
  /// invitation by name.
  bool is_personal() const { return is_pass() || !name.empty(); }
};

}  // namespace kerf
