// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "server/session/participant.h"

namespace kerf {

/// The participants of a session as viewers see them, by ascending id. In large sessions viewers
/// are counted, not listed: their names would dominate the server's traffic.
struct Roster {
  /// If a session has more viewers than this, none is listed.
  static constexpr std::size_t kListedViewersMax = 50;

  std::vector<Participant> listed;
  std::size_t viewers = 0;  ///< all of them, listed or not
};

/// The difference between two rosters of one session.
struct RosterChange {
  std::vector<Participant> changed;  ///< new, or with a changed tool, role, mute or reach
  std::vector<ParticipantId> left;   ///< no longer in the list
  std::size_t viewers = 0;           ///< of the newer roster
};

/// Returns the change that turns `from` into `to`, in linear time. Names and colors of a
/// participant never change.
RosterChange difference(const Roster& from, const Roster& to);

/// True if the two rosters are equal.
bool is_same(const Roster& one, const Roster& other);

}  // namespace kerf
