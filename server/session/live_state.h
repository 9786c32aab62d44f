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

/// The state of a session that viewers see and the journal lacks. Its owner sends it many times a
/// second to the servers that follow the session.
struct LiveState {
  std::vector<Participant> carvers;  ///< the agents and programs, by id
  wire::ToolStates tools;
  std::vector<ProgramGlance> programs;
  std::string paused;  ///< pause_word() while motions are rejected, else empty
  /// Viewers of the session by server, the owner's included.
  std::map<std::string, std::size_t> viewers;
};

/// Encodes the state as one message: u32 bytes of the JSON that follows, then a frame with the
/// tools.
std::vector<std::byte> encode_live(const LiveState& state);
/// Decodes such a message. Nullopt if the bytes are malformed.
std::optional<LiveState> decode_live(std::span<const std::byte> bytes);

}  // namespace kerf
