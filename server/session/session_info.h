// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "kernel/sculpture_state.h"
#include "server/session/matter.h"
#include "server/session/participant.h"
#include "server/session/program_runs.h"
#include "server/store/journal_reader.h"
#include "server/wire/types.h"

namespace kerf {

/// The state of the block that viewers need, read at one moment.
struct SessionFrame {
  std::uint64_t sequence = 0;  ///< of the last record applied
  std::uint64_t motions = 0;
  double removed_mm3 = 0;
  wire::ToolStates tools;
  std::vector<TileIndex> changed;         ///< since the previous frame; sorted
  std::optional<SolidSnapshot> snapshot;  ///< set if a tile changed or it was requested
  std::optional<StateHash> hash;          ///< the newest one known
  bool hash_is_current = false;           ///< `hash` belongs to the solid at `sequence`
  std::string paused;                     ///< pause_word() while motions are rejected, else empty
  /// The programs that have not ended and the newest that have. Set if one has changed since the
  /// previous frame with programs, at most every kProgramUpdateInterval.
  std::optional<std::vector<ProgramGlance>> programs;
  std::vector<MatterMessage> matters;  ///< changes since the previous frame
};

struct SessionInfo {
  std::string id;
  std::uint64_t sequence = 0, motions = 0, sub_motions = 0;
  double stock_mm3 = 0, removed_mm3 = 0, imprint_mm3 = 0;
  std::size_t journal_lag = 0;
  std::string paused;  ///< pause_word() while motions are rejected, else empty
  std::uint32_t epoch = 1;
  std::vector<Participant> participants;
};

/// Entries for lists of sessions, as of the last motion or change of the participants.
struct SessionFigures {
  std::uint64_t motions = 0;
  double removed_mm3 = 0;
  std::size_t participants = 0;
  /// When the session was created, and when its block or participants last changed, ms since 1970
  /// UTC; 0 if unknown.
  std::int64_t created_ms = 0, active_ms = 0;
};

}  // namespace kerf
