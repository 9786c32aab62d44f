// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace kerf::sim {

/// Exports a journal as a G-code program, carves the scene's block with it as kerf-carve does, and
/// compares the state hash with that of the session. Returns a sentence if they differ, else an
/// empty text. The journal's session is at rest.
std::string check_export(const std::filesystem::path& journal, std::uint64_t hash);

/// Flips single bits, drawn at random, of a copy of a journal that no server has open. For each bit
/// that changes the records or the lists, the reader or check_journal() must report damage. Returns
/// a sentence if neither does, else an empty text. `folder` is for the copy.
std::string check_rot(const std::filesystem::path& journal, const std::filesystem::path& folder);

}  // namespace kerf::sim
