// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "server/wire/types.h"

namespace kerf::agent {

/// Queue of samples without an answer from the server, sent or not, and of answered samples that
/// are not durable yet. A sample gets its number when it is first sent, so that numbers are
/// consecutive even after merging. After a reconnection all samples that the server lacks are
/// resent, preceded by the last one that it has, where the first motion starts. Cuts are
/// idempotent, so samples that had already arrived change nothing.
class SampleQueue {
 public:
  /// Capacity: eight seconds at 1 kHz.
  static constexpr std::size_t kMaxKept = 8192;
  /// Greatest number of answered samples that are not durable: a minute of a stalled disk. The
  /// oldest are dropped beyond that. A server accepts no more than this before its disk has caught
  /// up.
  static constexpr std::size_t kMaxNotDurable = 65'536;
  /// Greatest time between the oldest unanswered sample and one that may be sent. Bounds the
  /// backlog sent to a slow server. An older answer gives no force anyway.
  static constexpr std::uint64_t kWindowUs = 120'000;
  static constexpr std::uint64_t kMaxRttUs = 300'000;
  /// With more unsent samples than this the server is behind. Samples are then merged where that
  /// does not change the cut: through the air, and where the path is straight within the two
  /// tolerances below.
  static constexpr std::size_t kMergeAbove = 32;
  static constexpr std::size_t kLongestChord = 16;
  static constexpr double kChordMm = 0.005;
  static constexpr double kChordRad = 1e-4;

  /// Appends a sample. Its number is ignored.
  void push(const wire::MotionSample& sample);
  /// Returns the next samples to send, at most `most` and at most one message, all for one tool and
  /// within the window. Numbers the new ones.
  wire::MotionBatch take(std::size_t most);
  /// Contents of one datagram.
  struct Repeating {
    wire::MotionBatch batch;
    /// `due`: number of samples at the end of the batch that must be delivered; `fresh`: how many
    /// of those were never sent on this connection. Earlier samples are repetitions.
    std::uint32_t due = 0, fresh = 0;
  };
  /// Maximum number of due samples per datagram, so that even a backlog is sent in two datagrams.
  static constexpr std::size_t kNewPerDatagram = 8;
  /// Like take, for a datagram: at most `most` samples that were never sent on this connection,
  /// preceded by as many sent but unanswered ones as fit. All for `tool_id`. Empty if no sample is
  /// due.
  Repeating take_repeating(std::size_t most, std::uint32_t tool_id);
  /// Schedules all unanswered samples for resending on the same connection.
  void go_back() noexcept;
  /// Returns true if a sent sample is unanswered.
  bool in_flight() const noexcept { return last_number_ > answered_; }
  /// Marks all numbers up to this one as answered. Ignores a number that was never sent.
  void answered(std::uint64_t agent_sequence);
  /// Extends the window by the round-trip time, up to kMaxRttUs.
  void set_rtt(std::uint64_t rtt_us) noexcept { rtt_us_ = std::min(rtt_us, kMaxRttUs); }
  /// If set, keeps answered samples until durable() names them; otherwise releases them at once.
  void keep_until_durable(bool keep) noexcept { keeps_ = keep; }
  /// The server has stored all samples up to this number.
  void durable(std::uint64_t agent_sequence);
  /// Prepares for a new connection. `server_has`: number up to which the server has the samples. If
  /// 0, all samples that are not durable are resent.
  void rewind(std::uint64_t server_has = 0);

  std::size_t unsent() const noexcept { return samples_.size() - next_; }
  /// Returns true if every sample pushed so far is answered.
  bool settled() const noexcept;
  /// Number of unanswered samples, sent or not.
  std::uint64_t unanswered() const noexcept;
  /// Number of answered samples that may be lost with the server.
  std::uint64_t not_durable() const noexcept;
  /// Returns the tool of the next sample to send. Empty if there is none.
  std::optional<std::uint32_t> next_tool() const noexcept;

  std::uint64_t resent() const noexcept { return resent_; }
  /// Samples repeated along with new ones without evidence of loss.
  std::uint64_t repeated() const noexcept { return repeated_; }
  /// Samples through the air that were merged into the next one.
  std::uint64_t merged_air() const noexcept { return merged_air_; }
  /// Cutting samples dropped because the chord is the same path, within the tolerances.
  std::uint64_t merged_cuts() const noexcept { return merged_cuts_; }
  /// Cutting samples dropped because the queue was full: the path becomes a chord.
  std::uint64_t thinned_cuts() const noexcept { return thinned_cuts_; }
  /// Unanswered samples dropped because the queue was full.
  std::uint64_t forgotten() const noexcept { return forgotten_; }
  /// Answered samples dropped before they were durable, because there were too many.
  std::uint64_t given_up() const noexcept { return given_up_; }

 private:
  void drop_oldest();
  void drop_first();
  bool in_window(const wire::MotionSample& sample) const noexcept;
  std::size_t first_unanswered() const noexcept;
  void prepend_unanswered(wire::MotionBatch& batch, std::size_t end);
  std::size_t first_fresh() const noexcept;
  void merge_air();
  void merge_straight();
  void thin_cuts();
  void release_first();
  bool drop_unsent();

  /// Answered samples that are not durable, except the first, which may be; in order, before those
  /// of `samples_`.
  std::deque<wire::MotionSample> kept_;
  bool keeps_ = false;
  std::uint64_t durable_ = 0;
  /// Number of samples at the start of `samples_` that were answered before a rewind. They were
  /// felt, so they are not dropped.
  std::size_t returned_ = 0;
  std::uint64_t given_up_ = 0;
  /// In order. The first may be answered. It is kept as the start of the first motion.
  std::deque<wire::MotionSample> samples_;
  std::size_t next_ = 0;
  /// Number of samples at the end that have not been considered for merging. Each is considered
  /// once, because errors of chords over chords would add up.
  std::size_t fresh_ = 0;
  std::uint64_t rtt_us_ = 0;
  std::uint64_t last_number_ = 0;
  std::uint64_t connection_has_ = 0;  ///< newest number sent on this connection
  std::uint64_t answered_ = 0;
  std::uint64_t resent_ = 0;
  std::uint64_t repeated_ = 0;
  std::uint64_t merged_air_ = 0;
  std::uint64_t merged_cuts_ = 0;
  std::uint64_t thinned_cuts_ = 0;
  std::uint64_t forgotten_ = 0;
};

}  // namespace kerf::agent
