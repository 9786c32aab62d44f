// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <map>
#include <stop_token>
#include <string>
#include <tuple>
#include <vector>

#include "server/history/stroke_table.h"
#include "server/store/journal_reader.h"
#include "server/store/record_origins.h"

namespace kerf {

/// The newest undo or redo of a stroke in one journal. Of two journals, the greater one holds.
struct StrokeMark {
  std::uint64_t clock = 0;  ///< Lamport time
  std::string writer;
  std::uint64_t number = 0;
  bool undone = false;
  ParticipantId author = 0;
  friend auto operator<=>(const StrokeMark& a, const StrokeMark& b) {
    return std::tie(a.clock, a.writer, a.number) <=> std::tie(b.clock, b.writer, b.number);
  }
};

/// One of two journals that are merged: everything except its motions.
struct JournalSide {
  JournalHeader header;
  std::vector<JournalParticipant> participants;
  Lists lists;
  RecordOrigins origins;
  /// Of record n, at n − 1: the participant, and the stroke of a motion, or 0.
  struct Owner {
    ParticipantId participant = 0;
    StrokeId stroke = 0;
  };
  std::vector<Owner> owners = {};
  StrokeTable strokes = {};
  std::map<StrokeId, StrokeMark> marks = {};
  std::map<ToolId, Tool> tools = {};  ///< as of the last record
  double tolerance_mm = 0;            ///< of the scene

  std::uint64_t last() const { return owners.size(); }
};

/// Reads a whole journal. Needs 16 bytes of memory per record. Fails with kCorrupt for a damaged
/// journal and for one that begins with the block of a snapshot (salvage_writer.h), whose motions
/// are lost, and with kIo soon after a stop was requested.
std::expected<JournalSide, JournalError> read_side(const std::filesystem::path& file,
                                                   const std::stop_token& stop = {});

}  // namespace kerf
