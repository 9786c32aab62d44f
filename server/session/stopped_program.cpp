// SPDX-License-Identifier: Apache-2.0
#include "server/session/stopped_program.h"

#include <charconv>
#include <span>
#include <string>
#include <utility>

#include "server/store/byte_code.h"

namespace kerf {
namespace {

constexpr std::uint8_t kLayout = 1;

std::optional<StoppedProgram> program_of(const Attachment& attachment) {
  ByteReader in(attachment.bytes);
  if (attachment.kind != kProgramKind || in.get<std::uint8_t>() != kLayout) return std::nullopt;
  StoppedProgram program;
  ProgramStatus& status = program.status;
  const std::string& number = attachment.name;
  const auto parsed =
      std::from_chars(number.data(), number.data() + number.size(), status.participant);
  status.name = in.get_text();
  status.read_as = in.get_text();
  status.pace = in.get<std::uint8_t>() == 0 ? ProgramPace::kFast : ProgramPace::kFeed;
  status.speed = in.get_double();
  status.motions = in.get<std::uint64_t>();
  status.programmed_s = in.get_double();
  program.text = std::make_shared<const ProgramText>(in.get_text());
  if (parsed.ec != std::errc() || in.truncated() || !in.at_end()) return std::nullopt;
  return program;
}

}  // namespace

AttachmentChange stored(const ProgramStatus& status, const std::string& text) {
  ByteWriter out;
  out.put(kLayout);
  out.put_text(status.name);
  out.put_text(status.read_as);
  out.put(static_cast<std::uint8_t>(status.pace == ProgramPace::kFeed ? 1 : 0));
  out.put(status.speed);
  out.put(static_cast<std::uint64_t>(status.motions));
  out.put(status.programmed_s);
  out.put_text(text);
  return {kProgramKind, std::to_string(status.participant), out.take()};
}

AttachmentChange ended_program(ParticipantId participant) {
  return {kProgramKind, std::to_string(participant)};
}

std::vector<StoppedProgram> stopped_programs(const std::vector<Attachment>& attachments,
                                             const std::map<ParticipantId, std::uint32_t>& lines) {
  std::vector<StoppedProgram> list;
  for (const Attachment& attachment : attachments) {
    auto program = program_of(attachment);
    if (!program) continue;
    ProgramStatus& status = program->status;
    status.state = ProgramState::kCancelled;
    const auto line = lines.find(status.participant);
    if (line == lines.end()) {
      status.error = "the server that was to carve it has ended before its first motion";
    } else {
      status.line = line->second;
      status.error = "the server that carved it has ended: all before line " +
                     std::to_string(status.line) + " is cut; go on with that line";
    }
    list.push_back(*std::move(program));
  }
  return list;
}

}  // namespace kerf
