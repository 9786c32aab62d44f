// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "server/store/bit_code.h"
#include "server/store/journal_record.h"

namespace kerf {

/// Records of a batch, which the buffer of the writer can hold.
inline constexpr std::size_t kBatchRecordsMax = 65'536;

/// What a batch stores of one record.
struct BatchRecord {
  ParticipantId participant = 0;
  RecordedCommand command;
  bool begins_stroke = false;
};

/// The last motion of each participant, from which the next one is predicted. Encoder and decoder
/// hold the same states; a batch that restarts clears them.
class MotionStates {
 public:
  /// Tip and axis of a pose in steps of the pose grid.
  using Grid = std::array<std::int64_t, 6>;
  /// Participants, between two batches that restart: bounds the memory that a file can cause.
  static constexpr std::size_t kMax = kBatchRecordsMax;
  struct State {
    Grid before{}, at{};           ///< start and end of the last motion
    double duration_s = 0;         ///< of that motion
    std::int64_t duration_us = 0;  ///< rounded, for the prediction
    ToolId tool = 0;
    bool feel = true;
    /// Of the differences to the prediction, by coordinate; of the other numbers.
    std::array<NumberSize, 6> coordinates{};
    NumberSize duration, jump, other;
  };
  State& of(ParticipantId participant) { return states_[participant]; }
  std::size_t size() const { return states_.size(); }
  void clear() { *this = {}; }

  NumberSize participants, sizes;  ///< of participant numbers and of encoded commands
  unsigned flags = 0;              ///< of the last record

 private:
  std::map<ParticipantId, State> states_;
};

/// Encodes the records of a commit (README.md, "Batches"). Batches build on the ones before.
class BatchEncoder {
 public:
  /// A batch that restarts can be decoded without those before. The first one does, and one before
  /// which there could be more than MotionStates::kMax participants. Who reads a record in the
  /// middle of a journal begins with such a batch.
  static constexpr int kBatchesPerRestart = 256;
  static constexpr std::size_t kRecordsPerRestart = 2048;
  /// At most kBatchRecordsMax records.
  std::vector<std::byte> encode(std::span<const BatchRecord> records);

 private:
  MotionStates states_;
  int batches_ = 0;          ///< since the last one that restarts
  std::size_t records_ = 0;  ///< in these
};

/// Whether a batch can be decoded without those before.
bool restarts(std::span<const std::byte> bytes);

class BatchDecoder {
 public:
  /// Decodes the next batch, or one that restarts, with `count` records. The error is one sentence;
  /// afterwards only a batch that restarts can be decoded.
  std::expected<std::vector<BatchRecord>, std::string> decode(std::span<const std::byte> bytes,
                                                              std::size_t count);

 private:
  MotionStates states_;
  bool can_continue_ = false;
};

/// What is stored beside the bytes of a batch.
struct BatchHead {
  std::uint64_t first = 0, count = 0;  ///< sequence of its first record; number of records
  std::int64_t wall_ms = 0;            ///< when the first one was appended; ms since 1970, UTC
  std::int64_t span_ms = 0;            ///< from then to the last one

  /// When record `first` + n was appended, interpolated.
  std::int64_t wall_ms_of(std::uint64_t n) const {
    const auto steps = static_cast<std::int64_t>(count) - 1;
    return wall_ms + span_ms * static_cast<std::int64_t>(n) / (steps < 1 ? 1 : steps);
  }
};
inline constexpr std::int64_t kWallMaxMs = std::int64_t{1} << 53;  ///< of either sign
inline constexpr std::int64_t kSpanMaxMs = std::int64_t{1} << 40;

/// Returns the CRC-32 of a batch and its head, as a signed number, which SQLite stores in 4 bytes.
std::int32_t batch_checksum(const BatchHead& head, std::span<const std::byte> bytes);

}  // namespace kerf
