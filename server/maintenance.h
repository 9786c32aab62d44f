// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace kerf {

/// `kerf-server check`: prints one line for each journal and snapshot of a data folder. Returns the
/// exit status: 0, or 1 if something is wrong; the lines say what, and what to do.
int check_data(const std::filesystem::path& folder);

/// `kerf-server replay`: carves a journal from the start, compares it with its stored hashes and
/// its snapshot, and prints the outcome. Returns the exit status: 0, or 1 if something differs or
/// the journal cannot be read.
int replay_journal(const std::filesystem::path& file);

}  // namespace kerf
