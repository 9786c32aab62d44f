// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/math/vec3.h"

namespace kerf::agent {

/// A pose and when to be there. `cutting` and `tool_id` are those of the way from the pose before.
struct TimedPose {
  double time_s = 0;
  Vec3 tip_mm{};
  Vec3 axis{0, 0, 1};
  bool cutting = true;
  std::uint32_t tool_id = 0;

  bool operator==(const TimedPose&) const = default;
};

/// A path through poses with times that do not go back; at least one pose.
using PoseScript = std::vector<TimedPose>;

/// What is wrong with a file and where; `line` from 1, or 0 for the file as a whole.
struct ScriptError {
  std::string file;
  std::size_t line = 0;
  std::string reason;
};
/// "file:line: reason".
std::string to_string(const ScriptError& error);

/// How fast the tool goes where a program does not say: RAPID, and the way to a place where the
/// program starts anew (its first pose, another tool).
inline constexpr double kRapidMmPerS = 10000.0 / 60.0;
/// How fast the axis turns there where the tip rests.
inline constexpr double kTurnRadPerS = 1.0;

/// Speed of a move: of the tip, or, where the tip rests, of the axis.
struct MoveSpeed {
  double tip_mm_per_s = kRapidMmPerS;
  double turn_rad_per_s = kTurnRadPerS;
};
/// How long the move from one pose to the next takes.
double travel_time_s(const TimedPose& from, const TimedPose& to, const MoveSpeed& speed) noexcept;

/// APT CL data: GOTO, FROM, FEDRAT (mm/min), RAPID, LOADTL, and the words that do not move the
/// tool. Anything else is an error. Moves cut; the way to the first pose after FROM or LOADTL does
/// not.
std::expected<PoseScript, ScriptError> parse_apt_script(const std::string& name,
                                                        std::string_view text);
/// A table with a header: columns t_s, x, y, z, i, j, k, in any order; `cutting` (0 or 1) and
/// `tool` where present; others are skipped. The forces file of a carving is such a table.
std::expected<PoseScript, ScriptError> parse_csv_script(const std::string& name,
                                                        std::string_view text);
/// Reads a file, by its extension: .apt and .cls, or .csv.
std::expected<PoseScript, ScriptError> load_script(const std::string& path);

}  // namespace kerf::agent
