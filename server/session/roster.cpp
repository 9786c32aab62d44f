// SPDX-License-Identifier: Apache-2.0
#include "server/session/roster.h"

namespace kerf {
namespace {

bool is_different(const Participant& one, const Participant& other) {
  return one.tool != other.tool || one.role != other.role || one.is_muted != other.is_muted ||
         one.reach != other.reach;
}

}  // namespace

RosterChange difference(const Roster& from, const Roster& to) {
  RosterChange change;
  change.viewers = to.viewers;
  auto old = from.listed.begin();
  for (const Participant& participant : to.listed) {
    while (old != from.listed.end() && old->id < participant.id) change.left.push_back(old++->id);
    const bool known = old != from.listed.end() && old->id == participant.id;
    if (!known || is_different(*old, participant)) change.changed.push_back(participant);
    if (known) ++old;
  }
  for (; old != from.listed.end(); ++old) change.left.push_back(old->id);
  return change;
}

bool is_same(const Roster& one, const Roster& other) {
  const RosterChange change = difference(one, other);
  return change.changed.empty() && change.left.empty() && one.viewers == other.viewers;
}

}  // namespace kerf
