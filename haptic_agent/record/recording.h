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
  /// The file ends within a record or without its footer, because its program was killed.
  bool cut_off = false;
};

/// Reads a recording of kerf-agent, with chunks compressed by Zstandard or uncompressed. From a
/// truncated file, reads everything before the cut. Fails for other files, a wrong CRC and a
/// recording without ticks. The error is one sentence without its full stop.
std::expected<Recording, std::string> read_recording(const std::string& path);
/// Like read_recording, from the bytes of a file.
std::expected<Recording, std::string> parse_recording(std::span<const std::byte> bytes);

/// Writes the ticks as a table with a header. Its first columns are those of a pose list (t_s, x,
/// y, z, i, j, k, cutting, tool; t_s counts from the first tick), so the table can be replayed.
/// Wrenches are in N and N·mm.
void write_csv(std::ostream& out, const Recording& recording);

/// Returns the path of a recording: each pose with its time.
std::expected<PoseScript, std::string> path_of(const Recording& recording);

/// Returns the strokes of a recording as a teacher's stroke (../guides). It has the felt wrench at
/// the poses between touching down and lifting, with at least kStrokeStepMm of the tip between
/// poses. Its limits are the greatest force and torque among them. Fails if no force was felt in a
/// cut.
std::expected<Guide, std::string> stroke_of(const Recording& recording);
inline constexpr double kStrokeStepMm = 0.05;

}  // namespace kerf::agent
