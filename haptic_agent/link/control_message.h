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
#include "server/datagram/key.h"

namespace kerf::agent {

/// First message of an agent.
struct Hello {
  std::string name;
  /// "#rrggbb"; empty: the server chooses one.
  std::string color;
  /// 0: the server chooses the session's first tool.
  std::uint32_t tool_id = 0;
  /// Participant whose wrench is sent along (--feel); 0: none.
  std::uint32_t feel_of = 0;
  /// Request the UDP transport.
  bool udp = false;
  /// Request updates of the stock near the tool.
  bool stock = false;
};

/// The fields of the server's welcome that an agent uses.
struct Welcome {
  std::string session;
  std::uint32_t participant = 0;
  std::uint32_t epoch = 0;
  std::string color;
  double pivot_mm = 0;
  CutLaw law = CutLaw::kSpecificEnergy;
  /// Bounding box of the stock.
  StockBox stock;
  std::vector<std::uint32_t> tool_ids;
  /// The UDP transport; empty if it was not requested, or is unavailable or not supported here.
  std::optional<datagram::Offer> udp;
  /// The whole message, from which the replica is created.
  std::string text;
};

struct ServerError {
  std::string code;
  std::string reason;
  bool fatal = false;
};

struct Bye {
  std::string reason;
};

/// A message that an agent ignores.
struct OtherMessage {};

using ControlMessage = std::variant<Welcome, ServerError, Bye, OtherMessage>;

std::string hello_text(const Hello& hello);
std::string tool_text(std::uint32_t tool_id);
/// Requests the stock near the tool from scratch.
std::string stock_text();

/// Parses a text frame. The error is one sentence.
std::expected<ControlMessage, std::string> parse_control(std::string_view text);

}  // namespace kerf::agent
