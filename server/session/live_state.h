// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/session/participant.h"
#include "server/session/program_status.h"
#include "server/wire/types.h"

namespace kerf {

/// What viewers are shown of a session that is not in its journal, as its owner states it many
/// times a second to the servers that follow the session.
struct LiveState {
  std::vector<Participant> carvers;  ///< the agents and programs, by id
  wire::ToolStates tools;
  std::vector<ProgramGlance> programs;
  std::string paused;  ///< pause_word(): motions are rejected; empty: they are not
  /// Viewers of the session by server, the owner's included.
  std::map<std::string, std::size_t> viewers;
};

/// As the bytes of one message: u32 bytes of the JSON that follows, then a frame with the tools.
std::vector<std::byte> encode_live(const LiveState& state);
/// Nullopt for bytes that are no such message.
std::optional<LiveState> decode_live(std::span<const std::byte> bytes);

}  // namespace kerf
