// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "haptic_agent/device/carving_figure.h"
#include "haptic_agent/servo/local_model.h"
#include "haptic_agent/servo/mapping/workspace_mapping.h"
#include "server/datagram/key.h"

namespace kerf::agent {

/// First message of an agent.
struct Hello {
  std::string name;
  /// "#rrggbb". If empty, the server chooses one.
  std::string color;
  /// If 0, the server chooses the session's first tool.
  std::uint32_t tool_id = 0;
  /// Participant whose wrench is requested (--feel), or 0 for none.
  std::uint32_t feel_of = 0;
  /// Request the UDP transport.
  bool udp = false;
  /// Request updates of the stock near the tool, and the poses of other tools there.
  bool stock = false;
  /// Ask whether the server accepts 'reach' messages (reach_text).
  bool reach = false;
  /// Token of an earlier welcome, to continue as the same participant. Must not be logged.
  std::string resume = {};
};

/// States that the server reports durable samples, and how far a participant has come.
struct Resume {
  /// For the next hello. Must not be logged.
  std::string token;
  /// Number up to which the server has all samples. 0 if it has none.
  std::uint64_t agent_sequence = 0;
  /// This is the participant of the token in the hello.
  bool resumed = false;
};

/// The fields of the server's welcome that an agent uses.
struct Welcome {
  std::string session;
  std::uint32_t participant = 0;
  std::uint32_t epoch = 0;
  std::string color;
  double pivot_mm = 0;
  CutLaw law = CutLaw::kSpecificEnergy;
  /// Coefficients of the two laws, or 0 if not stated.
  double specific_force_n_per_mm2 = 0;
  double drr_n_s_per_mm3 = 0;
  /// Bounding box of the stock.
  StockBox stock;
  std::vector<std::uint32_t> tool_ids;
  /// The UDP transport. Empty if not requested, unavailable or not supported here.
  std::optional<datagram::Offer> udp;
  /// Empty if the server does not support it.
  std::optional<Resume> resume;
  /// The server accepts 'reach' messages.
  bool takes_reach = false;
  /// Addresses of the other servers that may continue the session, without invalid ones.
  std::vector<std::string> others;
  /// The message without its secrets, from which the replica is created.
  std::string text;
};

struct ServerError {
  std::string code;
  std::string reason;
  bool fatal = false;
};

struct Bye {
  std::string reason;
  std::string redirect;  ///< address of the server that continues the session; empty if none
};

/// A stroke of this agent has been undone or redone at its request.
struct StrokeChanged {
  bool undone = true;
  std::uint64_t stroke = 0;  ///< its first record
};

/// The agent's request to undo or redo had no effect.
struct ChangeRefused {
  bool undone = true;
  std::string code;
  std::string reason;
};

/// The list in Welcome::others has changed.
struct ServersChanged {
  std::vector<std::string> others;
};

/// A message that an agent ignores.
struct OtherMessage {};

using ControlMessage = std::variant<Welcome, ServerError, Bye, StrokeChanged, ChangeRefused,
                                    ServersChanged, OtherMessage>;

std::string hello_text(const Hello& hello);
std::string tool_text(std::uint32_t tool_id);
/// Undoes the agent's newest stroke, or redoes the last undone one.
std::string change_text(bool undone);
/// States the box of the block that the device reaches.
std::string reach_text(const Reach& reach);
/// Requests the stock near the tool from scratch.
std::string stock_text();

enum class ControlFault : std::uint8_t {
  kMalformed,   ///< not JSON, or a field is missing or has the wrong type
  kOutOfRange,  ///< a number of the welcome is outside the range that a device can render
};

struct ControlError {
  ControlFault fault = ControlFault::kMalformed;
  /// One clause; for kOutOfRange it names the field and its range.
  std::string reason;
};

/// Parses a text frame. Checks the ranges of the pivot, the force coefficients and the stock of a
/// welcome.
std::expected<ControlMessage, ControlError> parse_control(std::string_view text);

/// Returns the reason to show to a user from the body of a declined HTTP request, at most 200
/// bytes: the reason of the server's JSON error, or the first line of plain text. Empty for markup
/// and for other JSON.
std::string reason_of_body(std::string_view body);

}  // namespace kerf::agent
