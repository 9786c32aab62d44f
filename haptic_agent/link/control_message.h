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

/// Who comes to the block.
struct Hello {
  std::string name;
  /// "#rrggbb"; empty: the server picks one.
  std::string color;
  /// 0: the server picks the session's first.
  std::uint32_t tool_id = 0;
  /// The participant whose force is felt along; 0: nobody.
  std::uint32_t feel_of = 0;
  /// Ask for the UDP lane.
  bool udp = false;
  /// Wants to be told what the block near its tool still holds.
  bool stock = false;
};

/// What an agent needs of the server's welcome.
struct Welcome {
  std::string session;
  std::uint32_t participant = 0;
  std::uint32_t epoch = 0;
  std::string color;
  double pivot_mm = 0;
  CutLaw law = CutLaw::kSpecificEnergy;
  /// The box around the stock, whatever its shape.
  StockBox stock;
  std::vector<std::uint32_t> tool_ids;
  /// The UDP lane, if it was asked for, the server has one and this agent understands it.
  std::optional<datagram::Offer> udp;
  /// The whole message, for whoever makes a copy of the block.
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

/// A message that an agent has no use for.
struct OtherMessage {};

using ControlMessage = std::variant<Welcome, ServerError, Bye, OtherMessage>;

std::string hello_text(const Hello& hello);
std::string tool_text(std::uint32_t tool_id);
/// Asks for the block near the tool afresh.
std::string stock_text();

/// Reads a text frame. The error says what is wrong with it, in one sentence.
std::expected<ControlMessage, std::string> parse_control(std::string_view text);

}  // namespace kerf::agent
