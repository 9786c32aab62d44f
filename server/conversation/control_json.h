// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "server/datagram/key.h"
#include "server/feed/tile_detail.h"
#include "server/session/session.h"

namespace kerf::net {

/// What a peer may say in a text frame (server/wire/README.md).
struct HelloMessage {
  std::string name, color;
  ToolId tool = 0;  ///< 0: the first of the scene
  bool feel = true;
  ParticipantId feel_of = 0;  ///< whose force to send along; 0: nobody's
  bool udp = false;           ///< offer the UDP lane
  bool stock = false;         ///< wants stock frames
};
struct ToolMessage {
  ToolId tool = 0;
};
/// Finite; the eye at most 1000 m away, the angle from 0 to 1.
struct LookMessage {
  ViewerLook look;
};
/// Stock frames are to begin afresh.
struct StockMessage {};
using ControlMessage = std::variant<HelloMessage, ToolMessage, LookMessage, StockMessage>;

/// Reads one text frame. Unknown fields are skipped; errors are bad_json (no JSON object) or
/// bad_message (with the field).
std::expected<ControlMessage, Rejection> parse_control(std::string_view text);

std::string agent_welcome(const Session& session, const Participant& self,
                          const SessionLimits& limits, const datagram::Offer* udp = nullptr);
std::string viewer_welcome(const Session& session, const Participant& self,
                           const std::vector<Participant>& participants);
std::string participants_message(const std::vector<Participant>& participants);
std::string state_message(std::uint64_t motions, double removed_mm3, std::uint64_t hash,
                          bool settled);
std::string error_message(const Rejection& rejection, bool fatal);
std::string bye_message(std::string_view reason);

}  // namespace kerf::net
