// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "server/rights/caller.h"
#include "server/rights/role.h"

namespace kerf {

/// An action that needs a right. The first one is that of a route that names none, and reserved to
/// administrators.
enum class Action : std::uint8_t {
  kAdminister,
  kReach,
  kList,
  kWatch,
  kDownload,
  kCarve,
  kUndo,
  kMakeTools,
  kNameVersions,
  kPlacePins,
  kRunPrograms,
  kInvite,
  kModerate,
  kRenameSession,
  kCloseSession,
};

/// Returns whether a role may perform an action, from the table of README.md (rights.cpp). Every
/// check of the server calls this function.
bool may(Role role, Action action);

/// Returns whether a caller may change an existing thing: its own with the right `own`, and any
/// with Action::kModerate. `author` is the grant with which it was made (empty: nobody's in
/// particular). Holders of a shared invitation count as one.
bool may_change(const Caller& caller, std::string_view author, Action own);

/// The name of an action in errors and on the wire, e.g. "run_programs".
std::string_view to_string(Action action);

/// The first of watcher, sculptor, owner and administrator with a right, for error texts.
Role lowest_invited(Action action);

/// The names of the actions of a role, in the order of the table.
std::vector<std::string_view> allowed_actions(Role role);

/// The table of README.md.
std::string rights_markdown();

}  // namespace kerf
