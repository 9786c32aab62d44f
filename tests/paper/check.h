// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kerf::paper {

/// The result of checking a statement of the paper. The text is the same on every run.
struct Finding {
  bool holds = false;
  std::string figures;
};

/// A check of this folder: a test of paper_test, and a row of the page.
struct Check {
  const char* name;  ///< in CamelCase, the name of the test
  Finding (*run)();
};

/// Checks of updates and swept volumes, of forces, of models and programs, of the furniture
/// surface, and comparisons with voxels.
std::vector<Check> volume_checks();
std::vector<Check> force_checks();
std::vector<Check> output_checks();
std::vector<Check> furniture_checks();
std::vector<Check> voxel_checks();

/// Returns all checks.
const std::vector<Check>& checks();

/// Returns the result of a check, which runs at the first call.
const Finding& found(const std::string& name);

/// Formats numbers, as printf does.
std::string text(const char* format, ...) __attribute__((format(printf, 1, 2)));

}  // namespace kerf::paper
