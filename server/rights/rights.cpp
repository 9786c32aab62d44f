// SPDX-License-Identifier: Apache-2.0
#include "server/rights/rights.h"

#include <array>
#include <cstddef>

namespace kerf {
namespace {

/// One column per role, in their order; x: permitted.
using Roles = std::string_view;

struct Row {
  Action action;
  std::string_view name;
  Roles roles;
  std::string_view covers;
};

/// The table of rights: nobody, guest, watcher, sculptor, owner, administrator.
constexpr std::array kRows = {
    Row{Action::kReach, "reach", "xxxxxx",
        "the page, `/healthz`, `/readyz`, `/openapi.json`; exchange an invitation for a pass"},
    Row{Action::kList, "list", ".xxxxx", "the list of sessions; of an invitation, its own one"},
    Row{Action::kWatch, "watch", ".xxxxx", "join as a viewer; information, programs, regions"},
    Row{Action::kDownload, "download", ".xxxxx", "models, programs, forces, the journal"},
    Row{Action::kCarve, "carve", ".x.xxx", "join as an agent and cut; guests within limits"},
    Row{Action::kUndo, "undo", "...xxx", "undo and redo one's own strokes"},
    Row{Action::kMakeTools, "make_tools", "...xxx", "make tools for the session"},
    Row{Action::kNameVersions, "name_versions", "...xxx",
        "name versions of the block; rename and delete one's own"},
    Row{Action::kPlacePins, "place_pins", "...xxx", "set pins on the block; remove one's own"},
    Row{Action::kRunPrograms, "run_programs", "...xxx",
        "start NC programs, and pause, step, pace and cancel one's own; store target parts, and "
        "replace and delete one's own"},
    Row{Action::kInvite, "invite", "....xx", "make, list and revoke invitations"},
    Row{Action::kModerate, "moderate", "....xx",
        "remove and mute participants, change their roles; reserve regions, and cut in them; undo "
        "strokes of others, rename and delete their versions, remove their pins, control their "
        "programs, replace and delete their target parts"},
    Row{Action::kRenameSession, "rename_session", "....xx", "rename the session"},
    Row{Action::kCloseSession, "close_session", "....xx", "close the session, or delete it"},
    Row{Action::kAdminister, "administer", ".....x", "create sessions, upload meshes, `/metrics`"},
};

const Row& row_of(Action action) {
  for (const Row& row : kRows) {
    if (row.action == action) return row;
  }
  return kRows.back();
}

}  // namespace

bool may(Role role, Action action) {
  return row_of(action).roles[static_cast<std::size_t>(role)] == 'x';
}

bool may_change(const Caller& caller, std::string_view author, Action own) {
  if (may(caller.role, Action::kModerate)) return true;
  return may(caller.role, own) && !author.empty() && author == caller.grant;
}

std::string_view to_string(Action action) { return row_of(action).name; }

Role lowest_invited(Action action) {
  for (const Role role : {Role::kWatcher, Role::kSculptor, Role::kOwner}) {
    if (may(role, action)) return role;
  }
  return Role::kAdministrator;
}

std::vector<std::string_view> allowed_actions(Role role) {
  std::vector<std::string_view> names;
  for (const Row& row : kRows) {
    if (may(role, row.action)) names.push_back(row.name);
  }
  return names;
}

std::string rights_markdown() {
  std::string head = "| action |", line = "|---|", rows;
  for (const std::string_view role : kRoleNames) {
    head.append(" ").append(role).append(" |");
    line.append("---|");
  }
  for (const Row& row : kRows) {
    rows.append("| `").append(row.name).append("` |");
    for (std::size_t role = 0; role < kRoleNames.size(); ++role) {
      rows.append(may(static_cast<Role>(role), row.action) ? " yes |" : " |");
    }
    rows.append(" ").append(row.covers).append(" |\n");
  }
  return head + " covers |\n" + line + "---|\n" + rows;
}

}  // namespace kerf
