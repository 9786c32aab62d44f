// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kerf::paper {

/// A claim, an equation or a figure of the paper, and the check that reproduces it.
struct Row {
  std::string place = {};   ///< in the paper
  std::string states = {};  ///< what it states
  std::string where = {};   ///< where it is implemented
  std::string program =
      {};  ///< of tests, below the build's folder "tests"; "": a check of this folder
  /// Its tests as a gtest filter, or the name of the check. Empty without one.
  std::string check = {};
  std::string deviates = {};  ///< what differs, or cannot be reproduced, and why
};

/// Returns the rows of rows.psv.
const std::vector<Row>& rows();

}  // namespace kerf::paper
