// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "server/session/program_status.h"
#include "server/store/attachment.h"

namespace kerf {

/// Kind of the attachments that hold programs still running or queued, named by their participants.
inline constexpr const char* kProgramKind = "program";

/// The attachment of a program that has been started or queued.
AttachmentChange stored(const ProgramStatus& status, const std::string& text);
AttachmentChange ended_program(ParticipantId participant);

/// A program that was running or queued when its server ended.
struct StoppedProgram {
  ProgramStatus status;  ///< kCancelled, with the reason and the line from which to continue
  std::shared_ptr<const ProgramText> text;
};
/// The stopped programs of a journal. Malformed attachments are left out.
std::vector<StoppedProgram> stopped_programs(const std::vector<Attachment>& attachments,
                                             const std::map<ParticipantId, std::uint32_t>& lines);

}  // namespace kerf
