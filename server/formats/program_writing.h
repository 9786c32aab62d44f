// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>

#include "server/formats/program_writer.h"

namespace kerf {

// Shared by the writers of programs.

/// Significant digits of feeds.
inline constexpr int kFeedDigits = 7;

/// Returns an error if writing to the stream has failed.
WriteResult write_result(const std::ostream& out);

/// Replaces control characters by '?', so that a text cannot end the line of its comment.
std::string printable(std::string text);

/// Returns the distance from the tip, mm, up to which the tool axis matters: the length of the
/// tool, or the pivot distance if the scene does not contain the tool.
double reach_mm(const Scene& scene, ToolId tool);

}  // namespace kerf
