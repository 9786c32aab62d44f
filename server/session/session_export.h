// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <stop_token>
#include <string>

#include "kernel/math/wrench.h"
#include "server/formats/program_writer.h"
#include "server/session/felt_start.h"
#include "server/store/journal_record.h"

namespace kerf {

/// The error is one sentence. The exports end with an error soon after a stop was requested.
using ExportResult = std::expected<void, std::string>;

/// The motions to export, and the format and tolerance of the program.
struct ProgramRequest {
  ProgramStyle style = {};
  std::optional<ParticipantId> only = {};      ///< only motions of this participant
  std::uint64_t first = 0, last = UINT64_MAX;  ///< journal records, inclusive
};

/// Writes the motions of a journal as one program, participant by participant: each path stays
/// contiguous, and because cuts commute the solid is the same. Leaves out undone strokes. Reads the
/// journal twice and keeps no motions in memory.
ExportResult export_program(const std::filesystem::path& journal, const ProgramRequest& request,
                            std::ostream& out, const std::stop_token& stop = {});

/// The forces to export.
struct ForcesRequest {
  std::optional<ParticipantId> only = {};    ///< only lines of this participant
  std::optional<WrenchMaximum> device = {};  ///< adds the wrench as this device outputs it
};

/// Writes one line per motion (server/formats/forces_csv.h), in the order of application. Forces
/// are not stored: carving the journal again recomputes them exactly, as if undone strokes had
/// never happened.
ExportResult export_forces(const std::filesystem::path& journal, const ForcesRequest& request,
                           std::ostream& out, const std::stop_token& stop = {});

/// The forces to plot.
struct ForcePlotRequest {
  std::optional<ParticipantId> only = {};      ///< only motions of this participant
  std::uint64_t first = 1, last = UINT64_MAX;  ///< journal records, inclusive
  std::size_t points = 1000;                   ///< spans of records, 1 to kForcePointsMax
};
inline constexpr std::size_t kForcePointsMax = 5000;

/// Writes the forces of export_forces() as JSON with one value for each span of records
/// (ForcePlot). Carves the journal from `start` (SessionPast::felt_start), or from its first
/// record, to the last record of the plot.
ExportResult export_force_plot(const std::filesystem::path& journal,
                               const ForcePlotRequest& request, std::ostream& out,
                               const std::stop_token& stop = {}, const FeltStart* start = nullptr);

}  // namespace kerf
