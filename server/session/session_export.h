// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <filesystem>
#include <iosfwd>
#include <optional>
#include <string>

#include "server/formats/program.h"
#include "server/store/journal_record.h"

namespace kerf {

/// Why something could not be exported: one sentence.
using ExportResult = std::expected<void, std::string>;

/// Which motions of a journal, and how near to them the program must be.
struct ProgramRequest {
  ProgramFormat format = ProgramFormat::kGcode;
  std::optional<ParticipantId> only = {};      ///< of this participant alone
  std::uint64_t first = 0, last = UINT64_MAX;  ///< records of the journal, both included
  double tolerance_mm = 0;                     ///< motions are joined within it; 0: as they were
};

/// Writes the motions of a journal as one program, participant by participant (each one's path
/// stays whole; cuts commute, so the solid is the same). Reads the journal once per participant and
/// holds no motion in memory.
ExportResult export_program(const std::filesystem::path& journal, const ProgramRequest& request,
                            std::ostream& out);

/// Writes one line per motion, `t_s,x,y,z,i,j,k,fx_n,fy_n,fz_n,tx_nmm,ty_nmm,tz_nmm,removed_mm3`,
/// in the order in which the motions were applied, by carving the journal again with forces: they
/// are deterministic, so they need not be stored. With `only`, the lines of that participant alone.
ExportResult export_forces(const std::filesystem::path& journal, std::optional<ParticipantId> only,
                           std::ostream& out);

}  // namespace kerf
