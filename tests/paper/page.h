// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "tests/paper/rows.h"

namespace kerf::paper {

/// Returns whether the tests that a row names pass in their program.
using RunTests = std::function<bool(const Row&)>;

/// Returns the page's first part, the same on every run: pictures by name, all rows, tables.
/// `failed` receives the number of rows that fail.
std::string page_text(const RunTests& run_tests, int& failed);

/// Runs the tests of a row. They pass if the program exits with 0 and has run at least one.
bool run_tests(const Row& row);
/// Returns whether the program of a row has the tests that the row names, without running them.
bool has_tests(const Row& row);

}  // namespace kerf::paper
