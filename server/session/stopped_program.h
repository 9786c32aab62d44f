// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "server/session/program_status.h"
#include "server/store/attachment.h"

namespace kerf {

/// The kind of the attachments that are programs which have not ended, named by their participants.
inline constexpr const char* kProgramKind = "program";

/// A program that has begun, or waits.
AttachmentChange stored(const ProgramStatus& status, const std::string& text);
AttachmentChange ended_program(ParticipantId participant);

/// A program that had not ended when the server that carved it did.
struct StoppedProgram {
  ProgramStatus status;  ///< cancelled; why, and the line with which it may be continued
  std::shared_ptr<const ProgramText> text;
};
/// Those of a journal. Bytes that are none of a program are left out.
std::vector<StoppedProgram> stopped_programs(const std::vector<Attachment>& attachments,
                                             const std::map<ParticipantId, std::uint32_t>& lines);

}  // namespace kerf
