// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/formats/program_reader.h"
#include "server/formats/program_survey.h"

namespace kerf {

/// A program whose text has been read once and is read again while it is carved.
struct ProgramJob {
  std::string name;
  std::string read_as;  ///< its language and how it was recognized
  std::vector<std::string> warnings;
  ProgramTotals totals;
  double machine_s = 0;  ///< cycle time on the scene's machine
  OpenProgram open;
  std::optional<double> rate_hz = {};  ///< sample rate, if it is sampled

  ProgramJob() = default;
  /// `survey` holds the results of the first reading.
  ProgramJob(ReadProgram read, ProgramSurvey& survey, std::optional<double> rate);
  /// A program whose motions are known.
  ProgramJob(Program program);  // NOLINT(google-explicit-constructor): loses nothing
};

}  // namespace kerf
