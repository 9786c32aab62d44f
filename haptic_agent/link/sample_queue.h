// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "server/wire/types.h"

namespace kerf::agent {

/// Samples that the server has not answered yet, sent or not. Each gets its number when it is first
/// sent, so that numbers are consecutive even where samples have been merged. After a reconnection
/// everything that was not answered is sent again, behind the last sample that was: from there the
/// first motion starts. A cut made twice is the same cut, so this changes nothing that had arrived.
class SampleQueue {
 public:
  /// More than this are never kept: eight seconds at 1 kHz.
  static constexpr std::size_t kMostKept = 8192;
  /// No sample goes out that is more than this after the oldest unanswered one: a server that
  /// cannot keep up shall not be buried. An answer older than this gives no force anyway.
  static constexpr std::uint64_t kWindowUs = 120'000;
  static constexpr std::uint64_t kLongestWayUs = 300'000;
  /// With more than this unsent, the server is behind, and samples are merged where that costs
  /// nothing: through the air, and where the path is straight to within the two tolerances below.
  static constexpr std::size_t kMergeAbove = 32;
  static constexpr std::size_t kLongestChord = 16;
  static constexpr double kChordMm = 0.005;
  static constexpr double kChordRad = 1e-4;

  /// Takes a sample, whose number is ignored.
  void push(const wire::MotionSample& sample);
  /// The next samples to send, at most `most` (and what a message holds), all of one tool and
  /// within the window; numbers the new ones.
  wire::MotionBatch take(std::size_t most);
  /// What goes into one datagram, which may be lost.
  struct Repeating {
    wire::MotionBatch batch;
    /// How many at its end are not there just in case, and how many of these never went out before.
    std::uint32_t due = 0, fresh = 0;
  };
  /// Few new samples a datagram, so that even a backlog goes out in two datagrams each.
  static constexpr std::size_t kNewPerDatagram = 8;
  /// The next samples to send, as take does but at most `most` that never went out, behind
  /// unanswered ones that did, as many as fit. All of this tool; empty if there is none to send.
  Repeating take_repeating(std::size_t most, std::uint32_t tool_id);
  /// The connection holds, but what is unanswered has been lost: it goes out again.
  void go_back() noexcept;
  /// True if something that was sent is not answered.
  bool in_flight() const noexcept { return last_number_ > answered_; }
  /// All numbers up to this one are answered. A number that was never sent is ignored.
  void answered(std::uint64_t agent_sequence);
  /// The way to the server and back takes so long: the window grows by as much, up to
  /// kLongestWayUs.
  void allow_for(std::uint64_t rtt_us) noexcept { way_us_ = std::min(rtt_us, kLongestWayUs); }
  /// The connection is new: what is not answered goes out again.
  void rewind() noexcept;

  std::size_t unsent() const noexcept { return samples_.size() - next_; }
  /// True if every sample taken so far is answered.
  bool settled() const noexcept;
  /// Samples whose fate is unknown: sent or not, but not answered.
  std::uint64_t unanswered() const noexcept;
  /// The tool of the next sample to send; empty if there is none.
  std::optional<std::uint32_t> next_tool() const noexcept;

  std::uint64_t resent() const noexcept { return resent_; }
  /// Samples that went along with new ones although nobody knew them to be lost.
  std::uint64_t repeated() const noexcept { return repeated_; }
  /// Moves through the air that were merged into the next one.
  std::uint64_t merged_air() const noexcept { return merged_air_; }
  /// Cutting samples left out because the chord over them is the same path.
  std::uint64_t merged_cuts() const noexcept { return merged_cuts_; }
  /// Cutting samples left out because nothing else made room: the path there is a chord.
  std::uint64_t thinned_cuts() const noexcept { return thinned_cuts_; }
  /// Samples given up although the server had not answered them.
  std::uint64_t forgotten() const noexcept { return forgotten_; }

 private:
  void make_room();
  bool in_window(const wire::MotionSample& sample) const noexcept;
  std::size_t first_unanswered() const noexcept;
  void put_before(wire::MotionBatch& batch, std::size_t end);
  std::size_t first_fresh() const noexcept;
  void merge_air();
  void merge_straight();
  void thin_cuts();

  /// In order; the front one may be answered already and is kept as the place to start again from.
  std::deque<wire::MotionSample> samples_;
  std::size_t next_ = 0;
  /// How many at the end have not been looked at for merging. None is looked at twice, or the
  /// errors of chords over chords would add up.
  std::size_t fresh_ = 0;
  std::uint64_t way_us_ = 0;
  std::uint64_t last_number_ = 0;
  std::uint64_t answered_ = 0;
  std::uint64_t resent_ = 0;
  std::uint64_t repeated_ = 0;
  std::uint64_t merged_air_ = 0;
  std::uint64_t merged_cuts_ = 0;
  std::uint64_t thinned_cuts_ = 0;
  std::uint64_t forgotten_ = 0;
};

}  // namespace kerf::agent
