// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <expected>
#include <iosfwd>
#include <string>
#include <string_view>
#include <vector>

#include "haptic_agent/device/pose_script.h"
#include "haptic_agent/record/byte_writer.h"
#include "haptic_agent/servo/tick_tape.h"
#include "server/formats/guide.h"

namespace kerf::agent {

/// The contents of a recording.
struct Recording {
  std::vector<TickRecord> ticks;  ///< in the order of the file
  mcap::Texts about;              ///< metadata "kerf"
  mcap::Texts end;                ///< metadata "kerf_end"; empty if the recording was cut off
  /// The file ends in the middle of a record, or without its footer: its program was killed.
  bool cut_off = false;
};

/// Reads a recording of kerf-agent: chunks compressed by Zstandard or not at all; of a file that
/// was cut off, everything before the cut. Fails for other files, for a wrong CRC and for a
/// recording without ticks; the error is one sentence without its full stop.
std::expected<Recording, std::string> read_recording(const std::string& path);
/// As above, of the bytes of a file.
std::expected<Recording, std::string> parse_recording(std::span<const std::byte> bytes);

/// Writes the ticks as a table with a header. Its first columns are those of a pose list (t_s, x,
/// y, z, i, j, k, cutting, tool; t_s counts from the first tick), so that the table can be replayed
/// as such; wrenches are in N and N·mm.
void write_csv(std::ostream& out, const Recording& recording);

/// Returns the path of a recording: the pose of each tick that has one, with its time.
std::expected<PoseScript, std::string> path_of(const Recording& recording);

/// Returns the strokes of a recording as a teacher's stroke (../guides): the felt wrench at the
/// poses between touching down and lifting, at distances of at least kStrokeStepMm of the tip, with
/// the greatest force and torque among them as its limits. Fails if nothing was felt in a cut.
std::expected<Guide, std::string> stroke_of(const Recording& recording);
inline constexpr double kStrokeStepMm = 0.05;

}  // namespace kerf::agent
