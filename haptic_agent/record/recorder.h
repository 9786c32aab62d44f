// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <expected>
#include <memory>
#include <string>
#include <string_view>
#include <thread>

#include "haptic_agent/record/mcap_writer.h"
#include "haptic_agent/servo/tick_tape.h"

namespace kerf::agent {

/// Result of a recording.
struct RecordReport {
  std::string file;         ///< empty if nothing was recorded
  std::uint64_t ticks = 0;  ///< in the file
  /// Ticks missing from the file: the writer was 16 s behind, or a write had failed.
  std::uint64_t lost = 0;
  std::uint64_t bytes = 0;  ///< size of the file
  std::string error;        ///< see McapWriter::error
};

/// Returns one line about a recording, without a line break.
std::string record_text(const RecordReport& report);

/// Records every tick of a servo to an MCAP file, from an ordinary thread that wakes 10 times per
/// second. A chunk holds a second. The servo never waits for it.
class Recorder {
 public:
  /// Creates `file`, which must not exist, with `about` as the metadata "kerf" and `welcome` as
  /// the attachment welcome.json, and starts. The error is one sentence without its full stop.
  static std::expected<std::unique_ptr<Recorder>, std::string> start(const std::string& file,
                                                                     const mcap::Texts& about,
                                                                     std::string_view welcome);
  /// Ends the thread without finishing the file, which is then like that of a killed program.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Written by the servo thread.
  TickTape& tape() noexcept { return tape_; }

  /// Call after the servo's last tick: writes the rest and the end of the file, with `result` and
  /// the numbers of ticks as the metadata "kerf_end".
  RecordReport finish(mcap::Texts result);

 private:
  Recorder(std::string file, mcap::McapWriter writer, std::uint64_t utc_offset_ns);
  void drain();
  void end_thread();

  std::string file_;
  mcap::McapWriter writer_;
  std::uint64_t utc_offset_ns_;
  TickTape tape_;
  std::uint64_t taken_ = 0;
  std::uint64_t chunk_start_us_ = 0;
  mcap::Bytes message_;
  std::jthread thread_;
};

}  // namespace kerf::agent
