// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "server/rights/role.h"

namespace kerf {

/// Who sends a request, or opens a WebSocket, as far as its token tells.
struct Caller {
  Role role = Role::kNobody;
  std::string grant;         ///< id of its grant; empty: guest, administrator, nobody
  std::string invitation;    ///< the grant, or that for which it is a pass
  std::string session;       ///< of the grant
  bool is_personal = false;  ///< the grant belongs to one person
  std::string name, color;   ///< that the grant states; empty: the peer's own choice
  bool is_muted = false;
  std::int64_t remaining_s = -1;  ///< until the grant expires; negative: it does not
  std::string network = {};       ///< from which it comes; empty: unknown
  bool has_bad_token = false;     ///< a token that is unknown, expired or of another session
  /// The token may be one of a session that is not here, whose rights are where it runs.
  bool belongs_elsewhere = false;

  /// Whose turns its requests take: those of one grant, or of one role in one network.
  std::string client() const {
    return grant.empty() ? std::string(to_string(role)) + "@" + network : "grant " + grant;
  }

  /// Somebody on a server without rights: loopback, without tokens.
  static Caller local() {
    Caller caller;
    caller.role = Role::kAdministrator;
    return caller;
  }
};

}  // namespace kerf
