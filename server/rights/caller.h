// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "server/rights/role.h"

namespace kerf {

/// The sender of a request or WebSocket upgrade, as identified by its token.
struct Caller {
  Role role = Role::kNobody;
  std::string grant;         ///< id of its grant; empty: guest, administrator, nobody
  std::string invitation;    ///< the grant, or the invitation of a pass
  std::string session;       ///< of the grant
  bool is_personal = false;  ///< the grant belongs to one person
  std::string name, color;   ///< stated by the grant; empty: the peer's own choice
  bool is_muted = false;
  std::int64_t remaining_s = -1;  ///< until the grant expires; negative: never
  std::string network = {};       ///< of the client; empty: unknown
  bool has_bad_token = false;     ///< a token that is unknown, expired or of another session
  /// The token may be one of a session of another server, which has the session's rights.
  bool belongs_elsewhere = false;

  /// The client whose turns its requests take: one grant, or one role in one network.
  std::string client() const {
    return grant.empty() ? std::string(to_string(role)) + "@" + network : "grant " + grant;
  }

  /// A caller on a server without rights: loopback, without tokens.
  static Caller local() {
    Caller caller;
    caller.role = Role::kAdministrator;
    return caller;
  }
};

}  // namespace kerf
