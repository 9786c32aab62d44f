// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include "tests/paper/rows.h"

namespace kerf::paper {

/// Returns whether the tests that a row names hold in their program.
using RunTests = std::function<bool(const Row&)>;

/// The page's first part, the same on every run: pictures by name, all rows, tables. `failed`
/// receives the number of rows that fail.
std::string page_text(const RunTests& run_tests, int& failed);

/// Runs the tests of a row: they hold if the program exits with 0 and has run one at least.
bool run_tests(const Row& row);
/// Returns whether a row names tests that its program has, without running them.
bool has_tests(const Row& row);

}  // namespace kerf::paper
