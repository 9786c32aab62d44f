// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "server/formats/program.h"
#include "server/session/session_export.h"
#include "tests/server/undo_fixture.h"
#include "tests/support/test.h"

namespace kerf {

/// A session whose exported program is read and carved as by kerf-carve.
class SessionExport : public SessionUndo {
 protected:
  std::string exported(ProgramFormat format) {
    EXPECT_TRUE(session_->flush());
    std::ostringstream text;
    const auto ok = export_program(session_->journal_file(), {.style = {.format = format}}, text);
    EXPECT_TRUE(ok) << ok.error();
    return text.str();
  }
  /// Returns the hash of the block that the exported program carves.
  std::uint64_t carved(ProgramFormat format) {
    const std::string name = format == ProgramFormat::kApt ? "export.apt" : "export.ngc";
    const auto program = parse_program(name, exported(format), *session_->scene());
    if (!program) {
      ADD_FAILURE() << to_string(program.error());
      return 0;
    }
    Sculpture block = Sculpture::create(session_->scene()->settings).value();
    for (const auto& [id, tool] : session_->scene()->tools) {
      block.apply(DefineTool{id, tool.tool}).value();
    }
    for (const ProgramMotion& motion : program->motions) {
      block.apply(MoveTool{motion.tool, motion.from, motion.to, motion.duration_s, false}).value();
    }
    return block.state_hash();
  }
  void expect_equal_exports() {
    EXPECT_EQ(hash(), never_happened());
    EXPECT_EQ(carved(ProgramFormat::kGcode), hash());
    EXPECT_EQ(carved(ProgramFormat::kApt), hash());
  }
};

}  // namespace kerf
