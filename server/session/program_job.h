// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/formats/program_reader.h"
#include "server/formats/program_survey.h"

namespace kerf {

/// A program that has been read to its end and is read again while it is carved.
struct ProgramJob {
  std::string name;
  std::string read_as;  ///< language, and why it
  std::vector<std::string> warnings;
  ProgramTotals totals;
  double machine_s = 0;  ///< on the scene's machine
  OpenProgram open;
  std::optional<double> rate_hz = {};  ///< it is sampled

  ProgramJob() = default;
  /// What `survey` has found while it was read.
  ProgramJob(ReadProgram read, ProgramSurvey& survey, std::optional<double> rate);
  /// Of a program whose motions are known.
  ProgramJob(Program program);  // NOLINT(google-explicit-constructor): loses nothing
};

}  // namespace kerf
