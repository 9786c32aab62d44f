// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "server/convert/tool_track.h"
#include "server/feed/stock_feed.h"
#include "server/platform/clock.h"
#include "server/session/durable_mark.h"
#include "server/session/participant.h"
#include "server/session/rate_limit.h"
#include "server/store/resume_token.h"
#include "server/wire/types.h"

namespace kerf {

/// The state that a session keeps for one participant.
struct ParticipantState {
  Participant participant;
  std::string grant;          ///< grant by which it joined; empty if none
  std::string person;         ///< the grant, if it belongs to this participant only
  bool feel = true;           ///< compute forces for it
  ParticipantId feel_of = 0;  ///< participant whose force it receives too; 0 if none
  ToolTrack track;
  HeldCut held;
  std::uint64_t last_sequence = 0;  ///< agent_sequence of the newest sample
  /// It has resumed and sent no new sample yet: resent samples only place the tool.
  bool has_resumed = false;
  DurableMark durable;
  bool in_stroke = false;  ///< the next motion continues its stroke
  bool in_air = false;     ///< the newest motion of its program was a rapid clear of the stock
  /// Stock has come back to a tile within reach of its tool (Participants::note_returned).
  bool stock_came_back = false;
  /// Stock has come back around its tool, which cuts nothing until it is clear of the stock.
  bool is_in_stock = false;
  std::uint64_t in_stock_us = 0;   ///< time of the sample for which is_in_stock was checked last
  std::optional<TokenHash> token;  ///< set if it may resume
  std::uint64_t newest_us = 0;     ///< agent's time of the newest sample, accepted or rejected
  RateLimit samples{0, 0};
  double speed_mm_per_s = 0;  ///< maximum speed of the tip while cutting
  wire::ToolState display;    ///< the tool as viewers show it
  Clock::time_point display_time{};
  bool cuts = false;               ///< its newest motion cut, and was not rejected
  bool intent = false;             ///< receives the poses of tools near its own
  std::optional<StockFeed> stock;  ///< set if the agent keeps a replica of the block

  /// Updates `display` from the newest pose and the result of a batch.
  void update_display(const wire::Result& result, const BatchSum& sum);
  /// Shows the tool at another pose, with the force that is displayed.
  void show_at(const ToolPose& pose);
  /// Copies the device's output from the newest sample of a batch, if it states that, into
  /// `display`. Call it after update_display.
  void note_felt(const wire::MotionSample& newest);
  /// True while the force in `display` is recent enough to be forwarded.
  bool has_recent_force(Clock::time_point now) const;
};

}  // namespace kerf
