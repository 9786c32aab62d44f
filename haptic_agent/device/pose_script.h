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

/// A pose and its time. `cutting` and `tool_id` apply to the move from the previous pose.
struct TimedPose {
  double time_s = 0;
  Vec3 tip_mm{};
  Vec3 axis{0, 0, 1};
  bool cutting = true;
  std::uint32_t tool_id = 0;

  bool operator==(const TimedPose&) const = default;
};

/// A path: at least one pose, with non-decreasing times.
using PoseScript = std::vector<TimedPose>;

/// An error in a file; `line` counts from 1, 0 refers to the file as a whole.
struct ScriptError {
  std::string file;
  std::size_t line = 0;
  std::string reason;
};
/// Returns "file:line: reason".
std::string to_string(const ScriptError& error);

/// Shortest tool axis accepted from a file. Longer ones are normalized.
inline constexpr double kAxisMinLength = 1e-6;

/// Speed of moves without a programmed feed: RAPID, and the move to the first pose after the start
/// or a tool change.
inline constexpr double kRapidMmPerS = 10000.0 / 60.0;
/// Angular speed of such moves if the tip does not move.
inline constexpr double kTurnRadPerS = 1.0;

/// Speed of a move: of the tip or, if the tip does not move, of the axis.
struct MoveSpeed {
  double tip_mm_per_s = kRapidMmPerS;
  double turn_rad_per_s = kTurnRadPerS;
};
/// Returns the duration of the move from one pose to the next.
double travel_time_s(const TimedPose& from, const TimedPose& to, const MoveSpeed& speed) noexcept;

/// Parses APT CL data: GOTO, FROM, FEDRAT (mm/min), RAPID, LOADTL, DELAY, and words that do not
/// move the tool. Other words are errors. Moves cut, except the move to the first pose after FROM
/// or LOADTL.
std::expected<PoseScript, ScriptError> parse_apt_script(const std::string& name,
                                                        std::string_view text);
/// Parses a table with a header: columns t_s, x, y, z, i, j, k in any order, and optionally
/// `cutting` (0 or 1) and `tool`; other columns are ignored. The forces file of a carving is such a
/// table.
std::expected<PoseScript, ScriptError> parse_csv_script(const std::string& name,
                                                        std::string_view text);
/// Loads a file by its extension: .apt, .cls or .csv.
std::expected<PoseScript, ScriptError> load_script(const std::string& path);

}  // namespace kerf::agent
