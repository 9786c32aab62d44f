// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kernel/sculpture.h"
#include "server/store/journal_record.h"

namespace kerf {

enum class ParticipantKind { kAgent, kProgram, kViewer };
/// "agent", "program", "viewer".
const char* to_string(ParticipantKind kind);

/// Somebody at the block. Ids are never used again within a session, not even after a restart.
struct Participant {
  ParticipantId id = 0;
  ParticipantKind kind = ParticipantKind::kViewer;
  std::string name, color;  ///< color as "#rrggbb"
  ToolId tool = 0;          ///< 0 for viewers
};

/// What somebody asks for when they come.
struct JoinRequest {
  ParticipantKind kind = ParticipantKind::kViewer;
  std::string name;
  std::string color;  ///< empty: the session picks one
  ToolId tool = 0;
  bool feel = true;           ///< false: no force is computed for this participant
  ParticipantId feel_of = 0;  ///< whose force to answer beside its own; 0: nobody's
  bool stock = false;         ///< keeps a copy of the block near its tool (StockFeed)
};

}  // namespace kerf
